"""A fresh clone of this checkout with its compiled files, and snakemake in it."""

import os
import re
import shutil
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path

from numba.core.caching import _CacheLocator

from neol.base.kernel_cache import kernel_folder
from neol.rollout.worlds.box2d.library import LIBRARY
from neol.run.runner import run_block
from neol.spec.configuration import ROOT
from neol.study.campaign.jobs import Job, jobs
from neol.study.campaign.shown import figures_folder, select

SMOKE = ("--config", "budget=smoke")
FIGURES = figures_folder(select("smoke"))
"""Records of that budget."""
TARGETS = {"all", "tables", "figures", "claims", "beyond", "records", "total"}
JOB_COUNT = re.compile(r"^([\w.-]+) +(\d+)$", re.MULTILINE)


def fresh_clone(folder: Path) -> Path:
    """Clone HEAD and add all uncommitted changes."""
    subprocess.run(["git", "clone", "--quiet", "--no-hardlinks", ROOT, folder], check=True)
    changed = _listed("diff", "--name-only", "--no-renames", "HEAD")
    for path in changed + _listed("ls-files", "--others", "--exclude-standard"):
        (folder / path).parent.mkdir(parents=True, exist_ok=True)
        if (ROOT / path).exists():
            shutil.copy2(ROOT / path, folder / path)
        else:
            (folder / path).unlink(missing_ok=True)
    if LIBRARY.exists():
        shutil.copy2(LIBRARY, folder / LIBRARY.relative_to(ROOT))
    _share_kernels(folder)
    return folder


def _listed(*command: str) -> list[str]:
    """Return the paths that a command of git lists in this checkout."""
    run = ["git", *command, "-z"]
    listed = subprocess.run(run, cwd=ROOT, check=True, capture_output=True, text=True).stdout
    return listed.split("\0")[:-1]


def _share_kernels(clone: Path) -> None:
    """Let a clone use the kernels compiled here, which would be the same.

    Numba's cache has a folder for each folder of sources, and asks for the sources' times, as git
    does, which must not take them for changed.
    """
    sources = sorted((ROOT / "neol").rglob("*.py"))
    for source in sources:
        shutil.copystat(source, clone / source.relative_to(ROOT))
    subprocess.run(["git", "update-index", "-q", "--refresh"], cwd=clone)
    kernels = kernel_folder()
    assert kernels is not None
    for package in {source.parent for source in sources}:
        ours, its = (
            kernels / _CacheLocator.get_suitable_cache_subpath(folder / "any.py")
            for folder in (package, clone / package.relative_to(ROOT))
        )
        ours.mkdir(exist_ok=True)
        if not its.exists():
            its.symlink_to(ours)


def make_records(clone: Path, wanted: Callable[[Job], bool]) -> None:
    """Make some of the smallest budget's records here, which starts no process for each."""
    for job in filter(wanted, jobs(select("smoke"))):
        run_block(job.spec, job.seeds, clone / job.record, budget="smoke", reading=job.reading)


def snakemake(
    folder: Path, *arguments: str, code: Path | None = None
) -> subprocess.CompletedProcess[str]:
    """Run snakemake in a folder, with the code of that clone or of another one."""
    return subprocess.run(
        [sys.executable, "-m", "snakemake", *arguments],
        cwd=folder,
        env=os.environ | {"PYTHONPATH": str(code or folder), "MPLBACKEND": "any"},
        capture_output=True,
        text=True,
    )


def planned(folder: Path, *arguments: str, code: Path | None = None) -> dict[str, int]:
    """Count the jobs of each rule that a dry run plans, without rules that only collect others."""
    result = snakemake(folder, "--dry-run", *arguments, code=code)
    assert result.returncode == 0, result.stderr
    counts = {rule: int(count) for rule, count in JOB_COUNT.findall(result.stdout)}
    assert counts or "Nothing to be done" in result.stdout, result.stdout
    return {rule: count for rule, count in counts.items() if rule not in TARGETS}
