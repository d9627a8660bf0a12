"""Misbehaving environments end the run in one line or count as failed evaluations."""

from pathlib import Path

import numpy as np
import pytest

from neol.base.errors import UserError
from neol.run import checkpoint, runner
from neol.run.record_file import read_record
from tests.helpers import troubled
from tests.helpers.refusal import refusal
from tests.helpers.runs import block, names, result, run_spec


@pytest.mark.parametrize("environment", ["NaNObservation-v0", "NaNReward-v0"])
def test_nan_is_counted_and_the_run_goes_on(environment: str, tmp_path: Path) -> None:
    spec = run_spec(task=f"gym:{environment}", generations=4)
    record = block(tmp_path / "run.parquet", spec, seeds=(0,))
    failed = record.table["failed_evaluations"].to_pylist()
    assert 0 < failed[0] < 8 < failed[3] < 32
    assert failed == sorted(failed)
    for column in record.table.columns:
        assert np.isfinite(column.to_numpy()).all()
    best = record.table["best_fitness"].to_numpy()
    assert ((best >= 0) & (best <= 6)).all()
    assert result(read_record(tmp_path / "run.parquet", spec)) == result(record)


def test_a_run_whose_evaluations_all_failed_is_no_success(tmp_path: Path) -> None:
    spec = run_spec(task="gym:NaNAlways-v0")
    output = tmp_path / "run.parquet"
    said = refusal(block, output, spec, seeds=(0,))
    assert said.startswith("seed 0: all 32 evaluations failed: NaNAlways-v0 gives observations")
    assert refusal(block, output, spec, seeds=(0,), resume=True) == said
    assert not output.exists()


def test_an_image_is_refused_before_anything_is_written(tmp_path: Path) -> None:
    spec = run_spec(task="gym:Image-v0")
    with pytest.raises(UserError, match=r"Image-v0 observes .*a network needs a flat Box"):
        block(tmp_path / "run.parquet", spec)
    assert names(tmp_path) == []


@pytest.mark.slow
@pytest.mark.parametrize(
    ("trouble", "workers", "line"),
    [
        (
            "raise",
            1,
            "Troubled-v0 raised ZeroDivisionError: no luck (in step 3 of the episode with",
        ),
        (
            "raise",
            2,
            "Troubled-v0 raised ZeroDivisionError: no luck (in step 3 of the episode with",
        ),
        ("die", 2, "a worker process died (killed, or out of memory?); run again with --resume"),
    ],
)
def test_what_happens_in_an_environment_is_said_and_costs_no_generation(
    trouble: str, workers: int, line: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv(troubled.TROUBLE, str(tmp_path / "trouble"))
    monkeypatch.setattr(runner, "make_engine", troubled.make_engine)
    spec = run_spec(generations=8).model_copy(update={"task": troubled.TASK})
    undisturbed = result(block(tmp_path / "whole.parquet", spec))
    (tmp_path / "trouble").write_text(trouble)
    output = tmp_path / "run.parquet"
    said = refusal(block, output, spec, workers=workers)
    (kept,) = (tmp_path / "run.parquet.partial").glob("seed_*.npz")
    seed, generation = int(kept.stem[-6:]), checkpoint.generations_done(kept)
    assert generation > 0
    assert said.startswith(f"seed {seed}, generation {generation + 1}: ")
    assert line in said
    (tmp_path / "trouble").unlink()
    assert result(block(output, spec, workers=workers, resume=True)) == undisturbed
    assert names(tmp_path) == ["run.parquet", "whole.parquet"]
