"""What a sidecar says of the checkout and the records behind an output."""

import hashlib
import subprocess
from pathlib import Path
from typing import Any

import pytest

from neol.run import provenance, record_file
from neol.spec.run_spec import canonical_json
from neol.study.campaign.grid import cells
from neol.study.outcomes.campaign_runs import Campaign
from neol.study.outcomes.sensitivity import sensitivity
from neol.study.output.sidecar import Sidecar, write_sidecar
from tests.helpers import made_up


def git(folder: Path, *arguments: str) -> None:
    who = ("-c", "user.name=nobody", "-c", "user.email=nobody")
    subprocess.run(["git", "-C", folder, *who, *arguments], check=True, capture_output=True)


@pytest.fixture
def checkout(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """A checkout of its own that `provenance` is in, all committed."""
    root = tmp_path / "checkout"
    for name in ("neol/run/provenance.py", "paper/claims.yaml", "notebooks/a.ipynb", "docs/a.md"):
        (root / name).parent.mkdir(parents=True, exist_ok=True)
        (root / name).touch()
    git(tmp_path, "init", "--quiet", str(root))
    git(root, "add", ".")
    git(root, "commit", "--quiet", "-m", "All")
    monkeypatch.setattr(provenance, "__file__", str(root / "neol" / "run" / "provenance.py"))
    return root


@pytest.mark.parametrize(
    ("edited", "of_run", "of_output"),
    [
        ("docs/a.md", False, False),
        ("neol/run/provenance.py", True, True),
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
    assert sidecar.code(12) == sidecar.commit[:12] + "-dirty" * of_output


def test_the_configuration_is_named_by_its_canonical_json(tmp_path: Path) -> None:
    configuration, table = made_up.configuration(), tmp_path / "table1.tex"
    table.touch()
    write_sidecar([table], configuration, ())
    content = canonical_json(configuration.model_dump(mode="json"))
    named = Sidecar.read(table.with_suffix(".json")).configuration
    assert named == hashlib.sha256(content).hexdigest()


def test_a_source_is_of_the_bytes_that_were_read(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Also where another record takes a record's place while it is read."""
    configuration, results = made_up.configuration(), tmp_path / "results"
    made_up.write_campaign(results, configuration, {})
    made_up.write_trials(results, configuration, {"baseline": 0.0})
    before = {
        str(path.relative_to(tmp_path)): hashlib.sha256(path.read_bytes()).hexdigest()
        for path in results.rglob("*.parquet")
    }
    stored_spec = record_file._stored_spec

    def exchange(path: Path, text: bytes) -> dict[str, Any]:
        path.write_bytes(b"another record")
        return stored_spec(path, text)

    monkeypatch.setattr(record_file, "_stored_spec", exchange)
    sources = Campaign(configuration, results).sources(cells(configuration))
    sources += sensitivity(configuration, results)[1]
    assert {source.path: source.sha256 for source in sources} == before
