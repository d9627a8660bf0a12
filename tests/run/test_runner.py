"""Runs and blocks: an interruption does not change the record."""

import contextlib
import dataclasses
import json
import shutil
from collections.abc import Iterator
from functools import cache
from pathlib import Path
from typing import Any, NoReturn

import numpy as np
import pytest

from neol.base.errors import UserError
from neol.rollout.reference import ReferenceEngine
from neol.run import checkpoint, provenance, runner, single, workspace
from neol.run.evolution import Generation
from neol.run.provenance import Provenance
from neol.run.record import SeedInfo
from neol.run.record_file import read_record
from neol.run.runner import run_block
from neol.run.single import run_seed
from tests.helpers.damage import forge_checkpoint
from tests.helpers.runs import SPEC, block, evolve, killer, names, result, run_spec


def test_a_seed_is_its_evolution() -> None:
    engine = ReferenceEngine(SPEC.task)
    made, evolution = run_seed(SPEC, engine), evolve(SPEC)
    assert made.history == evolution.state.history
    assert made.digest == evolution.state.digest
    assert made.held_out_returns.tolist() == evolution.held_out_returns(engine).tolist()
    assert made.champion.connections.tolist() == evolution.champion().connections.tolist()
    assert made.engine == "reference"
    engine.close()


def test_a_block_is_its_seeds(tmp_path: Path) -> None:
    told: list[tuple[int, int]] = []
    record = block(
        tmp_path / "a" / "run.parquet",
        seeds=(3, 1),
        budget="smoke",
        on_generation=lambda seed, done: told.append((seed, done.generation)),
    )
    assert told == [(seed, generation) for seed in (1, 3) for generation in (1, 2, 3, 4)]
    assert record.seeds[1].digest == evolve(record.spec_of(3)).state.digest
    assert record.budget == "smoke"
    read = read_record(tmp_path / "a" / "run.parquet", SPEC)
    assert result(read) == result(record)
    assert names(tmp_path / "a") == ["run.parquet"]


@pytest.mark.parametrize("error", [KeyboardInterrupt, RuntimeError])
def test_stopped_after_any_generation_resumes_exactly(
    error: type[BaseException], tmp_path: Path
) -> None:
    undisturbed = result(block(tmp_path / "whole.parquet"))
    output = tmp_path / "run.parquet"
    for seed in (0, 1):
        for generation in (1, 2, 3, 4):
            with pytest.raises(error):
                block(output, resume=True, on_generation=killer(seed, generation, error))
            assert not output.exists()
            saved = checkpoint.read_checkpoint(
                tmp_path / "run.parquet.partial" / f"seed_{seed:06}.npz",
                SPEC.model_copy(update={"seed": seed}),
            )[0]
            assert saved.generation == generation
    assert result(block(output, resume=True)) == undisturbed
    assert names(tmp_path) == ["run.parquet", "whole.parquet"]


def test_the_commit_is_that_which_the_run_began_with(monkeypatch: pytest.MonkeyPatch) -> None:
    answers = {"rev-parse": "before", "status": ""}
    monkeypatch.setattr(provenance, "git", lambda command, *_: answers.get(command, ""))
    monkeypatch.setattr(runner, "checkout", cache(runner.checkout.__wrapped__))
    monkeypatch.setattr(provenance, "checkout", runner.checkout)

    def edit(_seed: int, _done: Generation) -> None:
        answers.update({"rev-parse": "after", "status": " M neol/run/runner.py"})

    (info,) = runner.evolve(SPEC, engine="reference", on_generation=edit).seeds
    assert (info.provenance.commit, info.provenance.dirty) == ("before", False)


def made_by(
    commit: str, output: Path, monkeypatch: pytest.MonkeyPatch, *, dirty: bool = False, **kw: Any
) -> Provenance:
    """Run a block with one seed in a checkout of that commit."""
    monkeypatch.setattr(provenance, "checkout", lambda: (commit, dirty))
    return block(output, seeds=(0,), resume=True, **kw).seeds[0].provenance


def test_a_resumed_run_names_all_code_that_made_it(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    output = tmp_path / "run.parquet"
    for commit, generation in (("aaa", 1), ("bbb", 2), ("aaa", 3)):
        with pytest.raises(KeyboardInterrupt):
            stop = killer(0, generation, KeyboardInterrupt)
            made_by(commit, output, monkeypatch, dirty=commit == "aaa", on_generation=stop)
    last = made_by("ccc", output, monkeypatch)
    assert [each.code() for each in last.each()] == ["bbb", "aaa-dirty", "ccc"]
    assert read_record(output).seeds[0].provenance == last


def test_a_run_resumed_by_the_same_code_names_it_once(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    output = tmp_path / "run.parquet"
    with pytest.raises(KeyboardInterrupt):
        made_by("aaa", output, monkeypatch, on_generation=killer(0, 2, KeyboardInterrupt))
    made = made_by("aaa", output, monkeypatch)
    assert made.earlier == ()
    assert b"earlier" not in output.read_bytes(), "an older neol can read it"


def test_a_checkpoint_without_provenance_is_of_unknown_code(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    def forget(arrays: checkpoint.Arrays) -> None:
        meta = json.loads(arrays["meta"].tobytes())
        del meta["provenance"]
        arrays["meta"] = np.frombuffer(json.dumps(meta).encode(), dtype=np.uint8)

    output = tmp_path / "run.parquet"
    with pytest.raises(KeyboardInterrupt):
        made_by("aaa", output, monkeypatch, on_generation=killer(0, 2, KeyboardInterrupt))
    forge_checkpoint(tmp_path / "run.parquet.partial" / "seed_000000.npz", forget)
    made = made_by("bbb", output, monkeypatch)
    assert [each.code() for each in made.each()] == ["unknown", "bbb"]


def test_a_checkout_of_another_user_has_a_commit(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(provenance, "this_package", lambda: tmp_path / "neol")
    provenance.git("init", "--quiet")
    monkeypatch.setenv("GIT_TEST_ASSUME_DIFFERENT_OWNER", "1")  # for Git's own tests
    assert provenance.git("rev-parse", "--show-toplevel") == str(tmp_path.resolve())


@pytest.mark.parametrize("seeds", [[], [0, 0]])
def test_seeds_are_distinct(seeds: list[int], tmp_path: Path) -> None:
    with pytest.raises(UserError, match="give at least one, each once"):
        runner.evolve(SPEC, seeds)
    with pytest.raises(UserError, match="give at least one, each once"):
        block(tmp_path / "run.parquet", seeds=tuple(seeds))


@pytest.mark.parametrize("seed", [-1, 2**63])
def test_seeds_are_what_a_record_holds(seed: int, tmp_path: Path) -> None:
    with pytest.raises(UserError, match="give integers from 0 to 9223372036854775807"):
        runner.evolve(SPEC, [seed])
    with pytest.raises(UserError, match="give integers from 0 to 9223372036854775807"):
        block(tmp_path / "run.parquet", seeds=(0, seed))
    with pytest.raises(UserError, match=f"seed = {seed}: must be"):
        run_spec(seed=seed)


def test_seeds_may_be_an_array() -> None:
    record = runner.evolve(SPEC, np.arange(2), engine="reference")  # type: ignore[arg-type]
    assert [info.seed for info in record.seeds] == [0, 1]


def test_checkpoints_come_as_often_as_asked(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    saved: list[int] = []
    monkeypatch.setattr(
        single, "write_checkpoint", lambda _path, run, _past: saved.append(run.generation)
    )
    block(tmp_path / "run.parquet", run_spec(generations=7), seeds=(0,), checkpoint_every=3)
    assert saved == [3, 6]


def test_costs_add_up_over_resumptions(tmp_path: Path) -> None:
    output = tmp_path / "run.parquet"
    with pytest.raises(KeyboardInterrupt):
        block(output, seeds=(0,), on_generation=killer(0, 3, KeyboardInterrupt))
    path = tmp_path / "run.parquet.partial" / "seed_000000.npz"
    evolution, past = checkpoint.read_checkpoint(path, SPEC)
    checkpoint.write_checkpoint(path, evolution, dataclasses.replace(past, wall_seconds=1000.0))
    info: SeedInfo = block(output, seeds=(0,), resume=True).seeds[0]
    assert info.wall_seconds > 1000.0


def test_a_finished_block_is_left_as_it_is(tmp_path: Path) -> None:
    output = tmp_path / "run.parquet"
    block(output)
    before = output.read_bytes()
    block(output, resume=True, on_generation=killer(0, 1, AssertionError))
    assert output.read_bytes() == before
    with pytest.raises(UserError, match=r"run\.parquet: already exists; remove it or choose"):
        block(output)
    with pytest.raises(UserError, match=r"contains seeds \[0, 1\], not \[0, 2\]"):
        block(output, seeds=(0, 2), resume=True)
    with pytest.raises(UserError, match="population is 8 there and 9 here"):
        block(output, run_spec(generations=4, population=9), resume=True)
    assert names(tmp_path) == ["run.parquet"]


def test_a_finished_block_needs_no_place_to_write(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Simulate a read-only folder, since root may write in real ones."""
    output = tmp_path / "run.parquet"
    made = block(output)
    monkeypatch.setattr(Path, "mkdir", refuse)
    assert result(block(output, resume=True)) == result(made)


def refuse(path: Path, *_: object, **__: object) -> NoReturn:
    raise PermissionError(13, "Permission denied", str(path))


def test_a_block_that_another_process_finishes_first_is_not_ours(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    output = tmp_path / "run.parquet"
    block(tmp_path / "other.parquet")

    @contextlib.contextmanager
    def claim_later(output: Path, **how: Any) -> Iterator[Path]:
        shutil.copy(tmp_path / "other.parquet", output)
        with workspace.claim(output, **how) as folder:
            yield folder

    monkeypatch.setattr(runner, "claim", claim_later)
    with pytest.raises(UserError, match=r"run\.parquet: already exists"):
        block(output)
    assert names(tmp_path) == ["other.parquet", "run.parquet"]


def test_interrupted_work_is_neither_lost_nor_mixed(tmp_path: Path) -> None:
    output = tmp_path / "run.parquet"
    with pytest.raises(KeyboardInterrupt):
        block(output, on_generation=killer(1, 2, KeyboardInterrupt))
    kept = ["lock", "run.parquet.partial", "seed_000000.parquet", "seed_000001.npz"]
    assert names(tmp_path) == kept
    with pytest.raises(
        UserError, match=r"has an interrupted run; continue with --resume, or remove"
    ):
        block(output)
    with pytest.raises(
        UserError, match=r"seed_000000\.parquet: of another specification: neat.*, or remove "
    ):
        block(output, run_spec("oja", 0, "neat.elitism=1", generations=4), resume=True)
    for seeds in ((5,), (0, 5)):
        with pytest.raises(UserError, match=r"contains seed_00000[01], which is not among"):
            block(output, seeds=seeds, resume=True, on_generation=killer(5, 1, AssertionError))
    assert names(tmp_path) == kept
    assert block(output, seeds=(0, 1, 5), resume=True).seeds[2].seed == 5


def test_more_seeds_than_a_record_holds_are_refused_before_simulating(tmp_path: Path) -> None:
    spec, output = run_spec("oja", 0, "evaluation.held_out_episodes=100000"), tmp_path / "a.parquet"
    with pytest.raises(
        UserError,
        match=r"a\.parquet: 50 seeds with 100000 held-out episodes each may be too large for one "
        r"record; run at most 6 seeds at a time",
    ):
        block(output, spec, seeds=tuple(range(50)), on_generation=killer(0, 1, AssertionError))
    assert names(tmp_path) == []


def test_a_block_has_one_budget_and_one_reading(tmp_path: Path) -> None:
    output = tmp_path / "run.parquet"
    label = {"budget": "smoke", "reading": "first"}
    other = {"budget": "demo", "reading": "worked_example"}
    with pytest.raises(KeyboardInterrupt):
        block(output, on_generation=killer(1, 2, KeyboardInterrupt), **label)
    with pytest.raises(
        UserError,
        match=r"seed_000000\.parquet: made with budget smoke and reading first, not budget demo "
        r"and reading worked_example; name those, or remove .*run\.parquet\.partial",
    ):
        block(output, resume=True, on_generation=killer(1, 3, AssertionError), **other)
    block(output, resume=True, **label)
    with pytest.raises(
        UserError,
        match=r"run\.parquet: made with budget smoke and reading first, not no budget and no "
        r"reading; name those, or choose another output",
    ):
        block(output, resume=True)


def test_finished_seeds_can_be_moved_to_another_output(tmp_path: Path) -> None:
    output, other = tmp_path / "run.parquet", tmp_path / "other.parquet"
    with pytest.raises(KeyboardInterrupt):
        block(output, on_generation=killer(1, 2, KeyboardInterrupt))
    with pytest.raises(UserError, match=r"or move the others to another output's \.partial folder"):
        block(output, seeds=(1,), resume=True, on_generation=killer(1, 3, AssertionError))
    (tmp_path / "other.parquet.partial").mkdir()
    (tmp_path / "run.parquet.partial" / "seed_000000.parquet").rename(
        tmp_path / "other.parquet.partial" / "seed_000000.parquet"
    )
    block(other, seeds=(0,), resume=True, on_generation=killer(0, 1, AssertionError))
    block(output, seeds=(1,), resume=True, on_generation=killer(1, 1, AssertionError))
    assert names(tmp_path) == ["other.parquet", "run.parquet"]


def test_a_block_killed_before_it_could_clean_up(tmp_path: Path) -> None:
    output = tmp_path / "run.parquet"
    with pytest.raises(KeyboardInterrupt):
        block(output, on_generation=killer(1, 2, KeyboardInterrupt))
    block(tmp_path / "other.parquet")
    (tmp_path / "other.parquet").rename(output)
    (tmp_path / "run.parquet.partial" / ".seed_000001.npz.tmp").write_bytes(b"half a file")
    block(output, resume=True, on_generation=killer(0, 1, AssertionError))
    assert names(tmp_path) == ["run.parquet"]


def test_an_impossible_output_is_said_before_simulating(tmp_path: Path) -> None:
    (tmp_path / "file").touch()
    for output in (tmp_path / "file" / "run.parquet", Path("/proc/neol/run.parquet")):
        with pytest.raises(UserError, match="cannot be made"):
            block(output, on_generation=killer(0, 1, AssertionError))


@pytest.mark.slow
def test_engine_and_workers_show_in_no_record(tmp_path: Path) -> None:
    records = [
        run_block(
            SPEC, (0, 1), tmp_path / f"{engine}{workers}.parquet", engine=engine, workers=workers
        )
        for engine, workers in (("reference", 1), ("reference", 2), ("auto", 1), ("auto", 2))
    ]
    assert [result(record) for record in records[1:]] == [result(records[0])] * 3
