"""A fresh clone of this checkout, and snakemake in it."""

import os
import re
import shutil
import subprocess
import sys
from pathlib import Path

from neol.selection import figures_folder, select
from neol.spec import ROOT

SMOKE = ("--config", "budget=smoke")
FIGURES = figures_folder(select("smoke").budget)
"""Of that budget."""
TARGETS = {"all", "tables", "figures", "claims", "beyond", "records", "total"}
JOB_COUNT = re.compile(r"^([\w.-]+) +(\d+)$", re.MULTILINE)


def fresh_clone(folder: Path) -> Path:
    """HEAD, cloned, and over it whatever is not committed yet."""
    subprocess.run(["git", "clone", "--quiet", "--no-hardlinks", ROOT, folder], check=True)
    listed = ["git", "ls-files", "-z", "--modified", "--others", "--exclude-standard"]
    changed = subprocess.run(listed, cwd=ROOT, check=True, capture_output=True, text=True).stdout
    for path in changed.split("\0")[:-1]:
        (folder / path).parent.mkdir(parents=True, exist_ok=True)
        if (ROOT / path).exists():
            shutil.copy2(ROOT / path, folder / path)
        else:
            (folder / path).unlink(missing_ok=True)
    return folder


def snakemake(clone: Path, *arguments: str) -> subprocess.CompletedProcess[str]:
    """Run snakemake in a clone, with the clone's own code."""
    return subprocess.run(
        [sys.executable, "-m", "snakemake", *arguments],
        cwd=clone,
        env=os.environ | {"PYTHONPATH": str(clone)},
        capture_output=True,
        text=True,
    )


def planned(clone: Path, *arguments: str) -> dict[str, int]:
    """How many jobs of each rule a dry run plans; rules that only gather others left out."""
    result = snakemake(clone, "--dry-run", *arguments)
    assert result.returncode == 0, result.stderr
    counts = {rule: int(count) for rule, count in JOB_COUNT.findall(result.stdout)}
    assert counts or "Nothing to be done" in result.stdout, result.stdout
    return {rule: count for rule, count in counts.items() if rule not in TARGETS}
