"""Where a result comes from: versions, commit, machine and time. Nothing of it is in a digest."""

import importlib.metadata
import os
import platform
import subprocess
from datetime import UTC, datetime
from functools import cache
from pathlib import Path

from neol.base.errors import UserError
from neol.spec.types import Model

PACKAGES = ("numpy", "numba", "gymnasium", "mujoco", "box2d", "neol")
CODE = ("neol", "config", "environment.lock")
"""What runs are made with, from the root of the checkout."""
ASKING_PACKAGE = "NEOL_PACKAGE"
"""The environment variable in which the workflow names the package that it runs."""


class Provenance(Model):
    """What made a run, apart from its specification."""

    versions: dict[str, str | None]
    """Of Python and the packages that numbers depend on; null where one is not installed."""
    commit: str | None
    """The checkout's when the first run of the process began; null outside one."""
    dirty: bool | None
    """Whether code or configuration differed from that commit then."""
    host: str
    platform: str
    cpu: str
    libc: str
    time: str
    """When the run finished: UTC, ISO 8601."""

    def code(self, digits: int | None = None) -> str:
        """The commit, so many digits of it; with -dirty where code or constants differed."""
        return describe_checkout(self.commit, self.dirty, digits)


def provenance() -> Provenance:
    """Of a run that finishes now, in this process."""
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
    """Of an installed package; None where it is not installed."""
    try:
        return importlib.metadata.version(package)
    except importlib.metadata.PackageNotFoundError:
        return None


def describe_checkout(commit: str | None, dirty: bool | None, digits: int | None = None) -> str:
    """As Git's own `describe` has it: the commit, and -dirty where what is looked at differed."""
    return f"{(commit or 'unknown')[:digits]}{'-dirty' if dirty else ''}"


@cache
def checkout(*further: str) -> tuple[str | None, bool | None]:
    """The commit that this file is tracked in, and whether code or constants differ from it.

    Or what else is named, by its path from the root.

    As they were at the first call of the process, which is for the first run to make when it
    begins: a run takes hours, and what is committed or edited meanwhile is not what it runs.
    """
    try:
        git("ls-files", "--error-unmatch", "neol/run/provenance.py")
        commit = git("rev-parse", "HEAD")
        changes = git("status", "--porcelain", "--", *CODE, *further)
    except (OSError, subprocess.CalledProcessError):
        return None, None
    return commit, bool(changes)


def this_package() -> Path:
    """The folder of the neol that runs."""
    return Path(__file__).resolve().parents[1]


def refuse_another_package() -> None:
    """Raise UserError where the workflow that started this process runs another neol.

    A notebook's kernel may be of another Python, with another installation.
    """
    asking = os.environ.get(ASKING_PACKAGE)
    if asking not in (None, str(this_package())):
        raise UserError(
            f"{this_package()}: not the neol that asks, {asking}; "
            f"install ipykernel beside that, or say PYTHONPATH={Path(asking).parent}"
        )


def git(*arguments: str) -> str:
    """What git says of the checkout that this package lies in.

    Raises OSError or subprocess.CalledProcessError where there is no git or no checkout.
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
