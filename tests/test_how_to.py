"""The how-to pages do what they say."""

import os
import re
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

from neol.records import read_record
from neol.spec import ROOT

PAGES = ROOT / "docs" / "how-to"


def blocks(page: str, language: str) -> list[str]:
    """The code blocks of a page in some language."""
    text = (PAGES / page).read_text(encoding="utf-8")
    return re.findall(rf"^```{language}\n(.*?)^```$", text, re.MULTILINE | re.DOTALL)


def shell(commands: str, folder: Path, package: Path = ROOT) -> str:
    """What commands print that run in a folder, with this neol or another copy of it."""
    binaries = f"{Path(sys.executable).parent}{os.pathsep}{os.environ['PATH']}"
    environment = os.environ | {"PATH": binaries, "PYTHONPATH": str(package)}
    done = subprocess.run(
        ["bash", "-euo", "pipefail", "-c", commands],
        cwd=folder,
        env=environment,
        capture_output=True,
        text=True,
    )
    assert done.returncode == 0, done.stderr
    return done.stdout


@pytest.mark.slow
def test_a_rule_in_a_script(tmp_path: Path) -> None:
    (script,), (commands,) = blocks("add-a-rule.md", "python"), blocks("add-a-rule.md", "sh")
    (tmp_path / "decaying.py").write_text(script)
    *_, digest = shell(commands, tmp_path).splitlines()
    record = read_record(tmp_path / "decaying.parquet")
    assert (record.spec.method, record.spec.plasticity.rule) == ("decaying_hebb",) * 2
    assert record.seeds[0].engine == "fast"
    again = commands.replace("decaying.parquet", "again.parquet --engine reference", 1)
    again = again.replace("digest decaying", "digest again")
    assert shell(again, tmp_path).splitlines()[-1] == digest
    assert read_record(tmp_path / "again.parquet").seeds[0].engine == "reference"


@pytest.mark.slow
def test_a_rule_in_the_repository(tmp_path: Path) -> None:
    for part in ("neol", "config"):
        shutil.copytree(ROOT / part, tmp_path / part, ignore=shutil.ignore_patterns("__pycache__"))
    (script,) = blocks("add-a-rule.md", "python")
    (function,) = re.findall(r"^@neol\.(rule\ndef .*?)^$", script, re.MULTILINE | re.DOTALL)
    digest = "python -c 'from neol.kernel import source_digest; print(source_digest())'"
    before = shell(digest, tmp_path, tmp_path)
    with (tmp_path / "neol" / "rules.py").open("a") as file:
        file.write(f"\n\n@{function}")
    assert shell(digest, tmp_path, tmp_path) != before, "or a stale kernel could be found"
    asked = (
        "python -m neol run --help; python -m neol config --schema; "
        "python -m neol config --budget smoke --set 'budget.methods=[decaying_hebb]'; "
        "python -m neol.spec"
    )
    assert shell(asked, tmp_path, tmp_path).count("decaying_hebb") > 4
    assert "decaying_hebb" in (tmp_path / "config" / "schema.json").read_text()
