"""Which commits there are: those that HEAD of this checkout leads back to."""

import subprocess
from functools import cache

from neol.run.provenance import Provenance, git


@cache
def ancestors() -> frozenset[str] | None:
    """The hashes of HEAD and all commits before it; None without a whole history.

    That is so outside a checkout and in a shallow one.
    """
    try:
        if git("rev-parse", "--is-shallow-repository") != "false":
            return None
        git("ls-files", "--error-unmatch", "neol/__init__.py")
        return frozenset(git("rev-list", "HEAD").split())
    except (OSError, subprocess.CalledProcessError):
        return None


def unknown_code(made: Provenance) -> str | None:
    """Why the code that made a run cannot be had again; None where it can, or nobody knows."""
    if made.commit is None:
        return "made outside a checkout: no commit is known"
    if made.dirty is not False:
        return f"made by code that differs from commit {made.commit[:12]}"
    known = ancestors()
    if known is not None and made.commit not in known:
        return f"its commit, {made.commit[:12]}, is not in the history of HEAD"
    return None
