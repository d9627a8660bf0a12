"""Repetition of drawn runs: what is drawn, when it ends, what counts; no run is made."""

import time
from pathlib import Path

import pytest

from neol.base.errors import UserError
from neol.study.verification import replays
from neol.study.verification.check import Problem
from neol.study.verification.repetition import Repetition, repeat_champion
from neol.study.verification.replay_log import ReplayLog
from neol.study.verification.replays import Coverage, Replay, Run


@pytest.fixture
def cells(tmp_path: Path) -> dict[Run, str]:
    """Two cells of three runs each."""
    paths = {cell: tmp_path / f"{cell}.parquet" for cell in "ab"}
    for cell, path in paths.items():
        path.write_text(cell)
    return {(path, seed): cell for cell, path in paths.items() for seed in range(3)}


def answer(monkeypatch: pytest.MonkeyPatch, replay: Replay) -> None:
    """Let all replays have this result."""
    monkeypatch.setattr(replays, "replay", lambda *_: replay)


def test_drawn_runs_are_counted(cells: dict[Run, str], monkeypatch: pytest.MonkeyPatch) -> None:
    answer(monkeypatch, Replay(5, None))
    repetition = Repetition(cells, count=4, seed=1)
    assert repetition.drawn == replays.draw(cells, 1)[:4]
    assert [repetition.repeat(run).generations for run in repetition.runs()] == [5] * 4
    assert (repetition.repeated, repetition.generations_done) == (4, 20)
    assert repetition.coverage() == Coverage(runs=4, of_runs=6, cells=2, of_cells=2)


def test_a_part_of_a_run_covers_nothing(
    cells: dict[Run, str], monkeypatch: pytest.MonkeyPatch
) -> None:
    answer(monkeypatch, Replay(2, None, whole=False))
    repetition = Repetition(cells, count=1, seed=1)
    repetition.repeat(*repetition.runs())
    assert (repetition.repeated, repetition.coverage().runs) == (1, 0)


def test_it_ends_at_the_deadline(cells: dict[Run, str], monkeypatch: pytest.MonkeyPatch) -> None:
    now = iter([10.0, 20.0, 30.0])
    monkeypatch.setattr(time, "monotonic", lambda: next(now))
    assert len(list(Repetition(cells, count=6, seed=1, deadline=25.0).runs())) == 2


def test_what_agreed_is_logged_and_not_drawn_again(
    cells: dict[Run, str], tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    log = ReplayLog(tmp_path / "log.txt")
    first = Repetition(cells, count=2, seed=1, log=log)
    answer(monkeypatch, Replay(5, None))
    first.repeat(first.drawn[0])
    answer(monkeypatch, Replay(5, Problem(Path("a.parquet"), "edited")))
    first.repeat(first.drawn[1])
    assert first.coverage().runs == 2
    again = Repetition(cells, count=6, seed=1, log=log)
    assert (again.before, len(again.drawn)) == (1, 5)
    assert first.drawn[0] not in again.drawn


def test_what_cannot_be_repeated_is_a_problem_and_does_not_count(
    cells: dict[Run, str], monkeypatch: pytest.MonkeyPatch
) -> None:
    def refuse(*_: object) -> Replay:
        raise UserError("no such rule")

    monkeypatch.setattr(replays, "replay", refuse)
    monkeypatch.setattr(replays, "replay_champion", refuse)
    repetition = Repetition(cells, count=1, seed=1)
    for replay in (repetition.repeat(repetition.drawn[0]), repeat_champion(repetition.drawn[0])):
        assert not replay.played
        assert "cannot be repeated: no such rule" in str(replay.problem)
    assert (repetition.repeated, repetition.coverage().runs) == (0, 0)
