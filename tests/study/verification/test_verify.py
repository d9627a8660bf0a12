"""Verification and replays: draws, summaries, manifests. Errors: planted."""

import re
import shutil
from collections.abc import Callable, Iterator
from pathlib import Path

import pytest

from neol.base.errors import UserError
from neol.rollout.environment import network_size
from neol.run.runner import run_block
from neol.spec.configuration import load_configuration
from neol.spec.observations import size_of
from neol.study.campaign.jobs import jobs
from neol.study.verification.manifest import NAME, read_manifest, write_manifest
from neol.study.verification.replays import Coverage, Replay, Run, coverage, draw
from neol.study.verification.returns import Returns, returns_of
from tests.helpers.command import neol
from tests.helpers.damage import Json, forge_record
from tests.study.verification.campaign import (
    HEBB,
    HOPPER,
    NEAT,
    OJA,
    TRIALS,
    make_campaign,
    patch_budget,
)
from tests.study.verification.planted.contents import seal_spec


@pytest.fixture(scope="module")
def campaign(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Path]:
    folder = tmp_path_factory.mktemp("results") / "smoke"
    with patch_budget():
        make_campaign(folder)
        yield folder


def test_draws_give_cells_equal_weight_and_never_repeat() -> None:
    sizes = {"few": 2, "many": 50}
    cells = {(Path(cell), seed): cell for cell, size in sizes.items() for seed in range(size)}
    order = draw(cells, 1)
    assert order == draw(dict(reversed(cells.items())), 1) != draw(cells, 2)
    assert sorted(order) == sorted(cells)
    for first in (0, 2):
        assert {cells[run] for run in order[first : first + 2]} == {"few", "many"}


def test_what_replays_find_is_a_share_of_runs_and_of_cells() -> None:
    cells = {(Path(cell), seed): cell for cell in "abcd" for seed in range(10)}
    some = coverage(cells, draw(cells, 0)[:3])
    assert some == Coverage(runs=3, of_runs=40, cells=3, of_cells=4)
    assert "one forged run is found with a chance of 7.5%, one forged cell of 75.0%" in str(some)


def test_the_manifest_is_the_same_each_time(campaign: Path, tmp_path: Path) -> None:
    campaign = shutil.copytree(campaign, tmp_path / "smoke")
    before = (campaign / NAME).read_bytes()
    (campaign / "x.parquet.partial").mkdir()
    (campaign / "x.parquet.partial" / "seed_000000.parquet").write_bytes(b"in progress")
    assert write_manifest(campaign) == read_manifest(campaign)
    assert (campaign / NAME).read_bytes() == before


def test_a_manifest_of_several_budgets_or_of_nothing_is_refused(
    campaign: Path, tmp_path: Path
) -> None:
    with pytest.raises(UserError, match="contains no records"):
        write_manifest(tmp_path)
    for name in ("a.parquet", "b.parquet"):
        (tmp_path / name).write_bytes((campaign / OJA).read_bytes())
    forge_record(tmp_path / "b.parquet", lambda metadata, _: metadata.update(budget="desk"))
    with pytest.raises(
        UserError, match=r"b\.parquet: is of first/desk, .*a\.parquet of first/smoke"
    ):
        write_manifest(tmp_path)


def test_a_manifest_above_a_budget_s_folder_is_refused(campaign: Path, tmp_path: Path) -> None:
    shutil.copytree(campaign, tmp_path / "smoke")
    with pytest.raises(UserError, match=r"smoke/.* first/smoke has no record of this name; write"):
        write_manifest(tmp_path)
    assert not (tmp_path / NAME).exists()


def test_records_without_a_manifest_are_reported(campaign: Path, tmp_path: Path) -> None:
    (tmp_path / "a.parquet").write_bytes((campaign / OJA).read_bytes())
    for path in (tmp_path, tmp_path / "a.parquet"):
        outcome = neol("verify", path)
        assert outcome.exit_code == 0
        assert outcome.stdout == (
            "1 record of 3 runs checked, 1 in no manifest.json (neol manifest FOLDER writes one): "
            "all well\n"
        )


def test_a_part_of_a_folder_is_checked_against_the_manifest_above(campaign: Path) -> None:
    part = neol("verify", campaign / "cartpole" / "oja")
    said = "1 record of 3 runs checked, 1 of 3 records of first/smoke: all well\n"
    assert part.stdout == said


def test_an_unfinished_campaign_is_no_finding_but_said(campaign: Path, tmp_path: Path) -> None:
    shutil.copytree(campaign, tmp_path / "smoke")
    (tmp_path / "smoke" / OJA).unlink()
    (tmp_path / "smoke" / NAME).unlink()
    outcome = neol("verify", tmp_path)
    assert outcome.exit_code == 0
    assert "2 of 3 records of first/smoke, 2 in no manifest.json" in outcome.stdout
    write_manifest(tmp_path / "smoke")
    assert f"{OJA}: missing, and manifest.json leaves it out" in neol("verify", tmp_path).stdout


def test_a_manifest_can_speak_for_some_tasks(campaign: Path, tmp_path: Path) -> None:
    folder = tmp_path / "first" / "smoke"
    shutil.copytree(campaign, folder)
    with patch_budget(HOPPER):
        write_manifest(folder)
        assert (
            f"{HOPPER}: missing, and manifest.json leaves it out" in neol("verify", folder).stdout
        )
        assert neol("manifest", folder, "--tasks", "cartpole").exit_code == 0
        assert read_manifest(folder).tasks == ("cartpole",)
        said = "3 records of 9 runs checked, 3 of 4 records of first/smoke: all well\n"
        assert neol("verify", folder).stdout == said
        (folder / OJA).unlink()
        write_manifest(folder, "cartpole")
        assert f"{OJA}: missing, and manifest.json leaves it out" in neol("verify", folder).stdout


@pytest.mark.parametrize(
    ("tasks", "line"),
    [
        ("hopper", f"{HEBB}: is of task cartpole, not of hopper; name all tasks"),
        ("hoper", 'budget smoke has no task "hoper", did you mean "hopper"?'),
    ],
)
def test_a_manifest_of_other_tasks_is_refused(campaign: Path, tasks: str, line: str) -> None:
    before = (campaign / NAME).read_bytes()
    outcome = neol("manifest", campaign, "--tasks", tasks)
    assert outcome.exit_code == 2
    assert line in outcome.stderr
    assert (campaign / NAME).read_bytes() == before


def test_of_a_sensitivity_study_all_trials_are_there_or_none(
    campaign: Path, tmp_path: Path
) -> None:
    folder = tmp_path / "first" / "smoke"
    shutil.copytree(campaign, folder)
    (job,) = (
        j
        for j in jobs(load_configuration("smoke", reading="first"), tmp_path)
        if j.record.match(TRIALS[0])
    )
    run_block(job.spec, job.seeds, job.record, budget="smoke", reading="first", engine="reference")
    write_manifest(folder)
    outcome = neol("verify", folder)
    assert f"{folder / TRIALS[1]}: missing, and manifest.json leaves it out" in outcome.stdout
    assert "4 records of 12 runs checked, 3 of 3 records of first/smoke: 1 finding" in (
        outcome.stdout
    )


def test_linked_folders_are_checked(campaign: Path, tmp_path: Path) -> None:
    (tmp_path / "smoke").symlink_to(campaign)
    outcome = neol("verify", tmp_path)
    said = "3 records of 9 runs checked, 3 of 3 records of first/smoke: all well\n"
    assert outcome.stdout == said


def test_what_is_found_does_not_depend_on_where_one_stands(
    campaign: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    shutil.copytree(campaign, tmp_path / "smoke")
    record = tmp_path / "smoke" / OJA
    record.write_bytes((campaign / HEBB).read_bytes())
    monkeypatch.chdir(record.parent)
    for path in (record.name, ".", f"../{record.parent.name}"):
        outcome = neol("verify", path)
        assert outcome.exit_code == 3
        assert "its SHA-256 is not that in manifest.json" in outcome.stdout
        assert outcome.stdout.startswith(
            str(Path(path, "" if path == record.name else record.name))
        )


def test_records_named_twice_are_checked_once(campaign: Path) -> None:
    outcome = neol("verify", campaign, campaign, campaign / OJA, campaign / "cartpole")
    said = "3 records of 9 runs checked, 3 of 3 records of first/smoke: all well\n"
    assert outcome.stdout == said


def test_what_was_repeated_is_said_with_the_seed_of_the_draw(campaign: Path) -> None:
    outcome = neol("verify", campaign, "--replay", 2, "--replay-champions", 1, "--seed", 5)
    assert outcome.exit_code == 0
    assert outcome.stdout == (
        "3 records of 9 runs checked, 3 of 3 records of first/smoke, 2 runs repeated, "
        "6 generations, one forged run is found with a chance of 22.2%, one forged cell of 66.7%, "
        "1 champion played again (--seed 5): all well\n"
    )
    assert "(--seed " in neol("verify", campaign, "--replay", 1).stdout


def test_first_generations_alone_find_no_whole_run(campaign: Path) -> None:
    outcome = neol("verify", campaign, "--replay", 2, "--generations", 2, "--seed", 5)
    assert "2 runs repeated, 4 generations" in outcome.stdout
    assert "one forged run is found with a chance of 0.0%" in outcome.stdout


def test_time_ends_a_verification(campaign: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    now = iter(range(10**6))  # a second each time that somebody asks
    monkeypatch.setattr("time.monotonic", lambda: float(next(now)))
    outcome = neol("verify", campaign, "--minutes", 0.25, "--seed", 5)
    assert outcome.exit_code == 0
    repeated = re.search(r"(\d+) runs? repeated", outcome.stdout)
    assert repeated
    assert 0 < int(repeated[1]) < 9
    assert "9 runs repeated" in neol("verify", campaign, "--minutes", 100, "--seed", 5).stdout


def test_what_agreed_is_not_repeated_another_time(campaign: Path, tmp_path: Path) -> None:
    log = tmp_path / "replayed.txt"
    first = neol("verify", campaign, "--replay", 4, "--log", log)
    assert "4 runs repeated" in first.stdout
    rest = neol("verify", campaign, "--replay", "all", "--log", log)
    assert "5 runs repeated, 15 generations, 4 repeated before, " in rest.stdout
    assert "one forged run is found with a chance of 100.0%" in rest.stdout
    assert len(log.read_text().splitlines()) == 9


def test_what_is_no_number_of_runs_is_refused(campaign: Path) -> None:
    outcome = neol("verify", campaign, "--replay", "some")
    assert outcome.exit_code == 2
    assert '--replay some: give a number of runs, or "all"' in outcome.stderr


def test_runs_and_champions_are_drawn_apart(
    campaign: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    drawn: list[list[Run]] = [[], []]

    def note(place: int) -> Callable[..., Replay]:
        def play(run: Run, *_: object) -> Replay:
            drawn[place].append(run)
            return Replay(0, None)

        return play

    monkeypatch.setattr("neol.study.verification.replays.replay", note(0))
    monkeypatch.setattr("neol.study.verification.replays.replay_champion", note(1))
    neol("verify", campaign, "--replay", 4, "--replay-champions", 4, "--seed", 0)
    assert drawn[0] != drawn[1]


def test_a_run_that_cannot_be_repeated_loses_no_other_finding(
    campaign: Path, tmp_path: Path
) -> None:
    (tmp_path / "a.parquet").write_bytes((campaign / NEAT).read_bytes())
    (tmp_path / "b.parquet").write_bytes(b"")

    def unknown(metadata: Json, _: Json) -> None:
        metadata["spec"]["task"]["environment"] = "Nowhere-v0"
        seal_spec(metadata)

    forge_record(tmp_path / "a.parquet", unknown)
    outcome = neol("verify", tmp_path, "--replay", 1, "--replay-champions", 1, "--seed", 0)
    assert outcome.exit_code == 3
    first, *again, summary = outcome.stdout.splitlines()
    assert first.startswith(f"{tmp_path / 'b.parquet'}: damaged")
    assert len(again) == 2
    assert all("cannot be repeated: " in line and "Nowhere-v0" in line for line in again)
    assert summary.endswith(": 3 findings")


def test_sizes_are_those_of_the_papers_environments() -> None:
    for task in load_configuration("paper").tasks.values():
        assert size_of(task.environment) == network_size(task)
    assert size_of("Acrobot-v1") is None


def test_where_there_is_nothing_to_check_the_input_is_wrong(tmp_path: Path) -> None:
    for path in (tmp_path, tmp_path / "missing"):
        outcome = neol("verify", path)
        assert outcome.exit_code == 2
        assert outcome.stderr.startswith(f"neol: {path}: ")


def test_no_manifest_is_written_below_another(campaign: Path) -> None:
    outcome = neol("manifest", campaign / "cartpole")
    assert outcome.exit_code == 2
    assert f"{campaign / NAME} covers it" in outcome.stderr


def test_without_a_history_commits_are_not_looked_up_and_that_is_said(
    campaign: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("neol.study.verification.history.ancestors", lambda: None)
    outcome = neol("verify", campaign)
    assert outcome.exit_code == 0
    assert "commits not looked up: no whole history is here" in outcome.stdout


def test_what_an_episode_returns_is_bounded_in_all_of_the_papers_environments() -> None:
    for task in load_configuration("paper").tasks.values():
        assert returns_of(task) is not None
    assert returns_of(load_configuration("smoke").tasks["cartpole"]) == Returns(1.0, 200.0, 1.0)
