"""Known commits: every part of a run needs code that can be restored."""

import pytest

from neol.run.provenance import UNKNOWN, Provenance
from neol.study.verification import history
from neol.study.verification.history import unknown_code
from neol.study.verification.manifest import ManifestEntry
from tests.helpers import made_up
from tests.helpers.runs import run_spec
from tests.study.verification.campaign import MADE_BY

DIRTY = MADE_BY.model_copy(update={"commit": "a" * 40, "dirty": True})


@pytest.mark.parametrize(
    ("earlier", "reason"),
    [
        (None, None),
        (MADE_BY, None),
        (MADE_BY.model_copy(update={"host": "there"}), None),
        (DIRTY, "made by code that differs from commit aaaaaaaaaaaa"),
        (UNKNOWN, "resumed from a checkpoint that states no commit"),
    ],
)
def test_code_that_made_a_run_in_part_must_be_known(
    earlier: Provenance | None, reason: str | None, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(history, "ancestors", lambda: {MADE_BY.commit})
    assert unknown_code(MADE_BY.after(earlier)) == reason


def test_a_manifest_lists_the_commits_of_each_part(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(made_up, "provenance", lambda: MADE_BY.after(DIRTY))
    record = made_up.run(run_spec(), "smoke", 1.0)
    entry = ManifestEntry.of("a.parquet", b"", record)
    assert entry.commits == ("0123456789abcdef", f"{'a' * 40}-dirty")
