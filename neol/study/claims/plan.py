"""The plan that was frozen before its runs: paper/plan.md and paper/questions.yaml.

paper/frozen.txt holds the SHA-256 of both; the plan's covers the text above its list of later
changes.
"""

import hashlib
import subprocess
from pathlib import Path

from neol.base.files import read_bounded, sha256
from neol.run.provenance import git
from neol.spec.configuration import ROOT
from neol.study.claims.questions import QUESTIONS

PLAN = ROOT / "paper" / "plan.md"
FROZEN = ROOT / "paper" / "frozen.txt"
LATER_CHANGES = "## Later changes"


def frozen_plan() -> str:
    """Return a sentence that names the plan, its SHA-256 and the commit that froze it."""
    commit = _commit(FROZEN) or "unknown"
    return f"Plan: `paper/plan.md`, SHA-256 `{plan_digest()[:16]}`, frozen at commit `{commit}`."


def plan_digest(plan: Path = PLAN) -> str:
    """Return the SHA-256 of the plan without its list of later changes."""
    text = read_bounded(plan, 2**20).decode()
    return hashlib.sha256(text.split(LATER_CHANGES)[0].encode()).hexdigest()


def digests() -> str:
    """Return the content of paper/frozen.txt for the files as they are now."""
    return f"{plan_digest()}  plan.md\n{sha256(QUESTIONS)}  questions.yaml\n"


def _commit(path: Path) -> str | None:
    """Return the last commit of a file; None outside a checkout, or before the first."""
    try:
        return git("log", "-1", "--format=%h", "--abbrev=12", "--", str(path)) or None
    except (OSError, subprocess.CalledProcessError):
        return None


if __name__ == "__main__":
    print(digests(), end="")
