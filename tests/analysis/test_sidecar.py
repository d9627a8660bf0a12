"""What a sidecar says of the checkout and the records behind an output."""

import subprocess
from pathlib import Path

import pytest

from neol import provenance
from neol.analysis.sidecar import Sidecar, write_sidecar
from tests.analysis import made_up


def git(folder: Path, *arguments: str) -> None:
    who = ("-c", "user.name=nobody", "-c", "user.email=nobody")
    subprocess.run(["git", "-C", folder, *who, *arguments], check=True, capture_output=True)


@pytest.fixture
def checkout(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """A checkout of its own that `provenance` is in, all committed."""
    root = tmp_path / "checkout"
    for name in ("neol/provenance.py", "paper/claims.yaml", "notebooks/a.ipynb", "docs/a.md"):
        (root / name).parent.mkdir(parents=True, exist_ok=True)
        (root / name).touch()
    git(tmp_path, "init", "--quiet", str(root))
    git(root, "add", ".")
    git(root, "commit", "--quiet", "-m", "All")
    monkeypatch.setattr(provenance, "__file__", str(root / "neol" / "provenance.py"))
    return root


@pytest.mark.parametrize(
    ("edited", "of_run", "of_output"),
    [
        ("docs/a.md", False, False),
        ("neol/provenance.py", True, True),
        ("paper/claims.yaml", False, True),
        ("notebooks/a.ipynb", False, True),
    ],
)
def test_what_an_edit_makes_dirty(
    edited: str, of_run: bool, of_output: bool, checkout: Path, tmp_path: Path
) -> None:
    (checkout / edited).write_text("edited")
    table = tmp_path / "table1.tex"
    table.touch()
    provenance.checkout.cache_clear()
    try:
        write_sidecar([table], made_up.configuration(), ())
        assert provenance.provenance().dirty == of_run
    finally:
        provenance.checkout.cache_clear()
    sidecar = Sidecar.read(table.with_suffix(".json"))
    assert sidecar.commit
    assert sidecar.dirty == of_output
