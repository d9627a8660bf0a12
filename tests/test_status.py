"""How far a campaign is: every state that a run may be in, and what the rest costs."""

import dataclasses
from collections.abc import Iterator
from pathlib import Path

import pytest
from typer.testing import CliRunner

from neol import selection
from neol import status as module
from neol.cli import app
from neol.cli import status as command
from neol.cost import run_seconds
from neol.jobs import Job
from neol.partial import finished_path, partial_folder
from neol.record import join
from neol.records import write_record
from neol.run import run_block
from neol.status import BASES, Folder, JobStatus, Row, Status
from tests.analysis import made_up
from tests.test_run import killer

CONFIGURATION = made_up.configuration(tasks=("cartpole", "hopper"))
"""Three seeds a job; two generations; P = 6 and 12; Hebb, Oja and BCM with two rates each."""


@pytest.fixture
def folder(tmp_path: Path) -> Folder:
    return Folder(tmp_path / "results" / "smoke", CONFIGURATION)


def job(folder: Folder, task: str = "cartpole", part: str = "hebb", place: int = 0) -> Job:
    """One of a row's jobs; the first has P = 6 and the lower rate."""
    return [s.job for s in folder.look() if (s.job.spec.task.name, s.job.part) == (task, part)][
        place
    ]


def status_of(folder: Folder, of: Job) -> JobStatus:
    return next(s for s in folder.look() if s.job.record == of.record)


def row(folder: Folder, task: str, part: str) -> Row:
    return next(r for r in Status(folder.look()).rows if (r.task, r.part) == (task, part))


def finish(of: Job, cpu_seconds: float = 0.0, seeds: int = 3, output: Path | None = None) -> None:
    """Write a record of so many of a job's seeds, each of which has cost so much."""
    made = []
    for seed in list(of.seeds)[:seeds]:
        record = made_up.run(of.spec.model_copy(update={"seed": seed}), "smoke", 7.0)
        cost = {"cpu_seconds": cpu_seconds, "wall_seconds": 2 * cpu_seconds}
        infos = tuple(info.model_copy(update=cost) for info in record.seeds)
        made.append(dataclasses.replace(record, seeds=infos))
    path = output or of.record
    path.parent.mkdir(parents=True, exist_ok=True)
    write_record(path, join(made))


def log(of: Job, text: str) -> None:
    of.log.parent.mkdir(parents=True, exist_ok=True)
    of.log.write_text(text)


@pytest.fixture
def unmeasured(monkeypatch: pytest.MonkeyPatch) -> None:
    """As if no task had ever been measured."""
    monkeypatch.setattr(module, "run_seconds", lambda _spec: None)


@pytest.mark.usefixtures("unmeasured")
def test_of_an_empty_folder_all_is_missing_and_no_cost_known(folder: Folder) -> None:
    status = Status(folder.look())
    assert status.states() == {"missing": 96}
    assert status.cells == (0, 32)
    assert [(r.task, r.part) for r in status.rows][-3:] == [
        ("hopper", "neat_wo"),
        ("cartpole", "sensitivity"),
        ("hopper", "sensitivity"),
    ]
    assert {(r.core_hours, r.basis) for r in status.rows} == {(None, "")}
    assert status.seconds_left is None
    assert not status.over


def test_a_record_is_done(folder: Folder) -> None:
    finish(job(folder))
    finish(job(folder, place=1), seeds=2)
    status = Status(folder.look())
    assert status.states() == {"done": 5, "missing": 91}
    assert status.cells == (1, 32)
    assert [run.spec.seed for run in status.finished] == [0, 1, 2, 0, 1]
    assert {(run.best_fitness, run.held_out) for run in status.finished} == {(7.0, 6.0)}


def test_where_nothing_is_done_a_run_costs_what_was_measured(folder: Folder) -> None:
    hebb = [
        s.job for s in folder.look() if (s.job.spec.task.name, s.job.part) == ("hopper", "hebb")
    ]
    seconds = sum(3 * (run_seconds(each.spec) or 0.0) for each in hebb)
    assert row(folder, "hopper", "hebb").core_hours == pytest.approx(seconds / 3600.0)
    assert row(folder, "hopper", "hebb").basis == "the shipped measurements"


@pytest.mark.usefixtures("unmeasured")
def test_the_rest_costs_what_the_nearest_finished_runs_did(folder: Folder) -> None:
    finish(job(folder), cpu_seconds=3600.0)  # Hebb's first of two rates at P = 6
    hebb = row(folder, "cartpole", "hebb")
    assert hebb.core_hours == pytest.approx(3 * 1 + 6 * 2)  # P = 12 costs twice as much
    assert hebb.basis == BASES[1]
    oja = row(folder, "cartpole", "oja")
    assert oja.core_hours == pytest.approx(6 * 1 + 6 * 2)
    assert oja.basis == BASES[2]
    assert row(folder, "hopper", "hebb").core_hours is None
    finish(job(folder, place=2), cpu_seconds=36.0)  # the same at P = 12
    assert row(folder, "cartpole", "hebb").core_hours == pytest.approx(3 * 1 + 3 * 0.01)
    assert row(folder, "cartpole", "hebb").basis == BASES[0]


def test_a_block_under_way(folder: Folder) -> None:
    """Its first run is done, its second has a checkpoint, and its third has not begun."""
    this, seen = job(folder), []

    def look(seed: int, generation: object) -> None:
        seen.append(status_of(folder, this))
        killer(1, 2, KeyboardInterrupt)(seed, generation)  # type: ignore[arg-type]

    this.record.parent.mkdir(parents=True)
    with pytest.raises(KeyboardInterrupt):
        run_block(
            this.spec, this.seeds, this.record, checkpoint_every=1, budget="smoke",
            engine="reference", on_generation=look,
        )  # fmt: skip
    assert [(s.seed, s.generation) for s in seen] == [(0, 1), (0, 2), (1, 1), (1, 2)]
    assert seen[2].states == {"done": 1, "running": 1, "missing": 1}
    assert seen[2].runs_left == 1.5
    assert status_of(folder, this).states == {"done": 1, "interrupted": 1, "missing": 1}


def test_a_block_that_ends_during_the_look(folder: Folder, monkeypatch: pytest.MonkeyPatch) -> None:
    this = job(folder)
    partial = partial_folder(this.record)
    finish(this, seeds=1, output=finished_path(partial, 0))
    exists, path = Path.exists, finished_path(partial, 0)

    def end(self: Path) -> bool:
        there = exists(self)
        if self == path and there:
            finish(this)
            path.unlink()
            partial.rmdir()
        return there

    monkeypatch.setattr(Path, "exists", end)
    assert status_of(folder, this).states == {"done": 3}


def test_a_record_that_comes_and_goes(folder: Folder, monkeypatch: pytest.MonkeyPatch) -> None:
    def vanish(path: Path, _spec: object) -> None:
        raise FileNotFoundError(2, "gone", str(path))

    this = job(folder)
    finish(this)
    monkeypatch.setattr(module, "read_footer", vanish)
    assert status_of(folder, this).reason == f"{this.record}: comes and goes"


@pytest.mark.parametrize(
    ("text", "reason"),
    [
        ("Traceback (most recent call last):\n  File\nMemoryError: no\n", "MemoryError: no"),
        ("neol: x.parquet: cannot be written\n\n", "neol: x.parquet: cannot be written"),
        ("Traceback (most recent call last):\n  File\nKeyboardInterrupt\n", ""),
        ("neol: terminated: what is done is kept\n", ""),
        ("neol: note: the reference engine plays CartPole-v1: no compiler\n", ""),
        ("neol: note: x.partial: another process is running this; waiting for it\n", ""),
        ("a warning\n", ""),
        ("", ""),
    ],
)
def test_a_log_that_ends_in_an_error(folder: Folder, text: str, reason: str) -> None:
    this = job(folder)
    log(this, text)
    assert status_of(folder, this).reason == reason
    assert status_of(folder, this).state == ("failed" if reason else "missing")
    finish(this)
    assert status_of(folder, this).states == {"done": 3}


def test_each_trial_has_a_log_of_its_own(folder: Folder) -> None:
    first = job(folder, part="sensitivity")
    trial = f"smoke/sensitivity/baseline/cartpole_{first.spec.method}"
    assert str(first.record).endswith(f"/results/{trial}.parquet")
    assert str(first.log).endswith(f"/logs/{trial}.log")
    log(first, "neol: no\n")
    assert [s.job for s in folder.look() if s.state == "failed"] == [first]


def test_a_time_that_is_none_fails_its_job_only(folder: Folder) -> None:
    this, other = job(folder), job(folder, place=1)
    finish(other)
    (info,) = (record := made_up.run(this.spec, "smoke", 7.0)).seeds
    foreign = info.provenance.model_copy(update={"time": "yesterday"})
    this.record.parent.mkdir(parents=True)
    changed = (info.model_copy(update={"provenance": foreign}),)
    write_record(this.record, dataclasses.replace(record, seeds=changed))
    assert "'yesterday' is no time" in status_of(folder, this).reason
    assert status_of(folder, other).state == "done"


def test_a_record_that_cannot_be_used_has_failed(folder: Folder) -> None:
    this, other = job(folder), job(folder, place=1)
    finish(other, output=this.record)
    assert "of another specification: plasticity.learning_rate" in status_of(folder, this).reason
    this.record.write_bytes(b"no record")
    assert status_of(folder, this).state == "failed"
    assert "seeds_000-002.parquet: damaged" in status_of(folder, this).reason


def test_a_record_is_read_once(folder: Folder, monkeypatch: pytest.MonkeyPatch) -> None:
    finish(job(folder))
    before = folder.look()
    monkeypatch.setattr(module, "read_footer", None)
    assert folder.look() == before


def test_the_time_left_is_that_of_the_jobs_that_run(
    folder: Folder, monkeypatch: pytest.MonkeyPatch
) -> None:
    for task in ("cartpole", "hopper"):
        finish(job(folder, task), cpu_seconds=10.0)
    assert Status(folder.look()).seconds_left is None
    for place in (1, 2):
        partial_folder(job(folder, place=place).record).mkdir(parents=True)
    monkeypatch.setattr(module, "is_running", lambda _: True)
    status = Status(folder.look())
    hours = sum(r.core_hours or 0.0 for r in status.rows)
    # Two jobs run, each at half a core: that is what the finished runs got.
    assert status.seconds_left == pytest.approx(3600 * hours / (2 * 0.5))


def test_looking_changes_nothing(folder: Folder) -> None:
    this = job(folder)
    with pytest.raises(KeyboardInterrupt):
        this.record.parent.mkdir(parents=True)
        run_block(
            this.spec, this.seeds, this.record, budget="smoke", engine="reference",
            on_generation=killer(1, 1, KeyboardInterrupt),
        )  # fmt: skip
    root = folder.path.parent.parent

    def tree() -> Iterator[tuple[Path, int, bytes]]:
        for path in sorted(root.rglob("*")):
            yield path, path.stat().st_mtime_ns, path.read_bytes() if path.is_file() else b""

    before = list(tree())
    assert status_of(folder, this).state == "interrupted"
    assert list(tree()) == before


# --- The command --------------------------------------------------------------------------------


@pytest.fixture
def smoke(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Folder:
    """The folder again, of a budget of which the command knows, below the working folder."""
    monkeypatch.chdir(tmp_path)
    monkeypatch.setattr(selection, "select", lambda *_: CONFIGURATION)
    return Folder(Path("results/smoke"), CONFIGURATION)


@pytest.mark.usefixtures("unmeasured")
def test_status_is_plain_lines(smoke: Folder) -> None:
    finish(job(smoke), cpu_seconds=36.0)
    log(job(smoke, place=1), "neol: disk full\n")
    outcome = CliRunner().invoke(app, ["status", "results/smoke"])
    assert outcome.exit_code == 0, outcome.output
    lines = [line.rstrip() for line in outcome.stdout.splitlines()]
    assert lines[0] == (
        "results/smoke: 3 of 96 runs done, 1 of 32 cells, 0 of 114 of the sensitivity study, "
        "1 failed"
    )
    assert "hopper will cost is unknown" in lines[1]
    assert lines[3].startswith("  cartpole hebb P=6 eta=0.0025 seed 2: best 7.0, held-out mean 6.0")
    failed = lines[lines.index("Failed:") + 1]
    assert failed.startswith("  cartpole hebb P=6 eta=0.25 seed 0: neol: disk full (")
    assert failed.endswith("logs/smoke/cartpole/hebb/p006_lr0.25/seeds_000-002.log)")
    header, hebb, *_ = lines[lines.index("") + 1 :]
    assert header.split()[:4] == ["task", "method", "runs", "done"]
    assert hebb.split()[:4] == ["cartpole", "hebb", "12", "3"]
    assert hebb.endswith("runs of other populations")
    assert CliRunner().invoke(app, ["status", "smoke"]).stdout.splitlines()[0] == lines[0]


def test_watch_goes_on_until_the_grid_is_done(
    smoke: Folder, monkeypatch: pytest.MonkeyPatch
) -> None:
    grid = [s.job for s in smoke.look() if s.job.part != "sensitivity"]
    finish(grid[0])

    def work(_seconds: float) -> None:
        for each in grid[1:]:
            finish(each)

    monkeypatch.setattr(command.time, "sleep", work)
    outcome = CliRunner().invoke(app, ["status", "smoke", "--watch"])
    assert outcome.stdout.startswith("results/smoke: 3 of 96 runs done, 1 of 32 cells")
    assert "results/smoke: 96 of 96 runs done, 32 of 32 cells" in outcome.stdout


@pytest.mark.usefixtures("smoke")
def test_ctrl_c_ends_a_watch(monkeypatch: pytest.MonkeyPatch) -> None:
    def interrupt(_seconds: float) -> None:
        raise KeyboardInterrupt

    monkeypatch.setattr(command.time, "sleep", interrupt)
    outcome = CliRunner().invoke(app, ["status", "smoke", "--watch"])
    assert outcome.exit_code == 130
    assert outcome.stderr.endswith("neol: interrupted\n")
    assert outcome.stdout.count("0 of 96 runs done") == 1


@pytest.mark.usefixtures("smoke")
def test_a_folder_that_does_not_exist_is_said() -> None:
    outcome = CliRunner().invoke(app, ["status", "smoke"])
    assert outcome.exit_code == 0
    assert outcome.stderr.startswith("neol: results/smoke does not exist (from ")


def test_a_folder_of_no_budget_is_refused(tmp_path: Path) -> None:
    outcome = CliRunner().invoke(app, ["status", str(tmp_path / "results" / "desky")])
    assert outcome.exit_code == 2
    assert outcome.stderr.startswith("neol: ") and "desk" in outcome.stderr
