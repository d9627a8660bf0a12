"""Notebooks run in the Python of the workflow, not in a user's kernels."""

import json
import os
import subprocess
import sys
from pathlib import Path

import pytest

from neol.run.provenance import ASKING_PACKAGE, this_package
from neol.study.campaign.shown import select
from neol.study.outcomes.campaign_runs import Campaign
from tests.helpers.refusal import refusal
from tests.workflow.clone import fresh_clone


def test_a_notebook_refuses_another_neol_than_the_one_that_asks(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.setenv(ASKING_PACKAGE, str(this_package()))
    Campaign(select("smoke"))
    monkeypatch.setenv(ASKING_PACKAGE, "/elsewhere/neol")
    line = refusal(Campaign, select("smoke"))
    assert line.startswith(f"{this_package()}: not the workflow's neol, /elsewhere/neol")


@pytest.mark.slow
def test_a_users_own_kernel_is_not_taken(tmp_path: Path) -> None:
    clone = fresh_clone(tmp_path / "neol")
    for folder in ("first", "data"):
        kernel = tmp_path / folder / "kernels" / "python3" / "kernel.json"
        kernel.parent.mkdir(parents=True)
        argv = ["touch", str(tmp_path / "TAKEN"), "{connection_file}"]
        kernel.write_text(json.dumps({"argv": argv, "display_name": "x", "language": "python"}))
    result = subprocess.run(
        [sys.executable, "-m", "snakemake", "figures/table3.tex"],
        cwd=clone,
        env=os.environ
        | {
            "PYTHONPATH": str(clone),
            "JUPYTER_PATH": str(tmp_path / "first"),
            "JUPYTER_DATA_DIR": str(tmp_path / "data"),
        },
        capture_output=True,
        text=True,
    )
    assert not (tmp_path / "TAKEN").exists()
    assert result.returncode == 0, result.stderr
