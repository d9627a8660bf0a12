"""The files of an installed neol."""

import subprocess
import sys
import zipfile
from pathlib import Path

import pytest

from neol.spec.configuration import ROOT


@pytest.mark.slow
def test_the_wheel_carries_every_file_that_the_code_reads(tmp_path: Path) -> None:
    build = [sys.executable, "-m", "hatchling", "build", "--target", "wheel"]
    subprocess.run([*build, "--directory", tmp_path], cwd=ROOT, check=True, capture_output=True)
    (wheel,) = tmp_path.glob("*.whl")
    carried = set(zipfile.ZipFile(wheel).namelist())
    read = [ROOT / "paper/claims.yaml", *ROOT.glob("paper/reference/*.csv")]
    read += ROOT.glob("config/**/*.yaml")
    assert {f"neol/{path.relative_to(ROOT)}" for path in read} <= carried
