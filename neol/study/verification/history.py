"""Known commits: HEAD of this checkout and its ancestors."""

import subprocess
from functools import cache

from neol.run.provenance import UNKNOWN, Provenance, git


@cache
def ancestors() -> frozenset[str] | None:
    """Return the hashes of HEAD and all its ancestors; None without a complete history.

    The history is incomplete outside a checkout and in a shallow one.
    """
    try:
        if git("rev-parse", "--is-shallow-repository") != "false":
            return None
        git("ls-files", "--error-unmatch", "neol/__init__.py")
        return frozenset(git("rev-list", "HEAD").split())
    except (OSError, subprocess.CalledProcessError):
        return None


def unknown_code(made: Provenance) -> str | None:
    """Return why the code of a run cannot be restored; None if it can, or if that is unknown.

    A resumed run needs the code of each of its parts.
    """
    return next(filter(None, map(_unknown_code_of_part, made.each())), None)


def _unknown_code_of_part(made: Provenance) -> str | None:
    if made == UNKNOWN:
        return "resumed from a checkpoint that states no commit"
    if made.commit is None:
        return "made outside a checkout: no commit is known"
    if made.dirty is not False:
        return f"made by code that differs from commit {made.commit[:12]}"
    known = ancestors()
    if known is not None and made.commit not in known:
        return f"its commit, {made.commit[:12]}, is not in the history of HEAD"
    return None
