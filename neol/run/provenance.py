"""Provenance of a result: versions, commit, machine and time; no digest includes it."""

import importlib.metadata
import operator
import os
import platform
import subprocess
from datetime import UTC, datetime
from functools import cache
from pathlib import Path
from typing import Annotated

from pydantic import Field

from neol.base.errors import UserError
from neol.spec.types import Model

PACKAGES = ("numpy", "numba", "gymnasium", "mujoco", "box2d", "neol")
CODE = ("neol", "config", "environment.lock")
"""Files that runs are made with, from the root of the checkout."""
ASKING_PACKAGE = "NEOL_PACKAGE"
"""Environment variable in which the workflow names the package that it runs."""


class Provenance(Model):
    """Provenance of a run, apart from its specification."""

    versions: dict[str, str | None]
    """Versions of Python and the packages that numbers depend on; null if not installed."""
    commit: str | None
    """Commit of the checkout when the process's first run began; null outside a checkout."""
    dirty: bool | None
    """Whether code or configuration differed from that commit at that time."""
    host: str
    platform: str
    cpu: str
    libc: str
    time: str
    """End of the run: UTC, ISO 8601. In `earlier`, when it began or was resumed there."""
    earlier: Annotated[tuple["Provenance", ...], Field(exclude_if=operator.not_)] = ()
    """Other code and machines that made the run's first part, before it was resumed; left out of a
    record if there are none."""

    def each(self) -> tuple["Provenance", ...]:
        """Return the provenance of each part of the run, the last one at the end."""
        return *self.earlier, self.model_copy(update={"earlier": ()})

    def after(self, before: "Provenance | None") -> "Provenance":
        """Return the provenance of a run that began with `before` and was resumed with this one.

        Parts that differ only in time count as one.
        """
        mine, others = self._without_time(), before.each() if before else ()
        earlier = tuple(each for each in others if each._without_time() != mine)
        return self.model_copy(update={"earlier": earlier})

    def _without_time(self) -> "Provenance":
        return self.model_copy(update={"time": "", "earlier": ()})

    def code(self, digits: int | None = None) -> str:
        """Return the commit's first digits, with -dirty if code or constants differed."""
        return describe_checkout(self.commit, self.dirty, digits)


UNKNOWN = Provenance(
    versions={},
    commit=None,
    dirty=None,
    host="unknown",
    platform="unknown",
    cpu="unknown",
    libc="unknown",
    time="unknown",
)
"""Provenance of generations in a checkpoint that states none, as those of an earlier neol."""


def provenance() -> Provenance:
    """Return the provenance of this process, now."""
    commit, dirty = checkout()
    return Provenance(
        versions={"python": platform.python_version(), **{p: package_version(p) for p in PACKAGES}},
        commit=commit,
        dirty=dirty,
        host=platform.node(),
        platform=platform.platform(),
        cpu=f"{os.cpu_count()} x {_cpu_model()}",
        libc=" ".join(platform.libc_ver()).strip(),
        time=datetime.now(UTC).isoformat(timespec="seconds"),
    )


def package_version(package: str) -> str | None:
    """Return the version of an installed package; None if it is not installed."""
    try:
        return importlib.metadata.version(package)
    except importlib.metadata.PackageNotFoundError:
        return None


def describe_checkout(commit: str | None, dirty: bool | None, digits: int | None = None) -> str:
    """Return the commit's first digits, with -dirty for changes, in the style of `git describe`."""
    return f"{(commit or 'unknown')[:digits]}{'-dirty' if dirty else ''}"


@cache
def checkout(*further: str) -> tuple[str | None, bool | None]:
    """Return the commit of this checkout, and whether code, constants or `further` paths differ.

    Paths count from the root. Both values are those of the process's first call, which the first
    run makes when it begins: a run takes hours and does not use what is edited meanwhile.
    """
    try:
        git("ls-files", "--error-unmatch", "neol/run/provenance.py")
        commit = git("rev-parse", "HEAD")
        changes = git("status", "--porcelain", "--", *CODE, *further)
    except (OSError, subprocess.CalledProcessError):
        return None, None
    return commit, bool(changes)


def this_package() -> Path:
    """Return the folder of the running neol."""
    return Path(__file__).resolve().parents[1]


def refuse_another_package() -> None:
    """Raise UserError if the workflow that started this process runs another neol.

    A notebook's kernel may belong to another Python, with another installation.
    """
    asking = os.environ.get(ASKING_PACKAGE)
    if asking not in (None, str(this_package())):
        raise UserError(
            f"{this_package()}: not the workflow's neol, {asking}; "
            f"install ipykernel beside that, or set PYTHONPATH={Path(asking).parent}"
        )


def git(*arguments: str) -> str:
    """Return the output of git in the checkout of this package.

    Raises OSError or subprocess.CalledProcessError without git or a checkout.
    """
    # By default Git refuses a checkout of another user, whose code is running here anyway.
    folder = str(this_package().parent)
    command = ["git", "-C", folder, "-c", "safe.directory=*", *arguments]
    return subprocess.run(command, check=True, capture_output=True, text=True).stdout.strip()


@cache
def _cpu_model() -> str:
    try:
        for line in Path("/proc/cpuinfo").read_text().splitlines():
            if line.startswith("model name"):
                return line.partition(":")[2].strip()
    except OSError:
        pass
    return platform.processor() or platform.machine()
