"""The search for readings: its candidates, its seeds, and which runs it shares."""

from pathlib import Path

import pytest

from neol.spec.configuration import READINGS, ROOT, budgets, load_configuration
from neol.spec.readings import FIRST_READING, readings
from neol.study.campaign import search
from neol.study.campaign.grid import RESULTS
from neol.study.campaign.jobs import jobs
from neol.study.campaign.search import (
    CONFIRMATION,
    SCREENING,
    baseline_blocks,
    calls,
    candidates,
    source,
)
from tests.helpers.refusal import refusal
from tests.helpers.runs import evolve, run_spec

MUTATION = {
    f"{what}_{constant}": 0.5
    for what in ("weight", "bias")
    for constant in ("mutate_rate", "mutate_power", "replace_rate")
}


def test_every_reading_but_the_first_is_a_candidate_that_the_plan_names() -> None:
    assert set(candidates()) == set(readings(READINGS)) - {FIRST_READING}
    plan = (ROOT / "docs" / "readings-plan.md").read_text()
    places = [plan.index(f"`{name}`") for name in candidates()]
    assert places == sorted(places), "in its order"


def test_shared_runs_of_neat_without_mutation_are_the_same() -> None:
    """Their specifications differ in what mutates weights alone, and that is not used."""
    cell = {"task": "lunar_lander", "method": "neat_wo", "population": 300, "generations": 500}
    for reading in candidates():
        own, shared = (
            load_configuration(SCREENING, reading=name).run_spec(**cell)
            for name in (reading, source(reading, "neat_wo"))
        )
        assert own.neat.model_copy(update=MUTATION) == shared.neat.model_copy(update=MUTATION)
        assert own.model_copy(update={"neat": shared.neat}) == shared
    changes = [f"neat.{key}={value}" for key, value in MUTATION.items()]
    assert (
        evolve(run_spec("neat_wo", 0, *changes)).state.history
        == evolve(run_spec("neat_wo")).state.history
    )


def test_the_search_has_seeds_of_its_own() -> None:
    seeds = {
        name: {seed for job in jobs(load_configuration(name)) for seed in job.seeds}
        for name in budgets()
    }
    for stage in (SCREENING, CONFIRMATION):
        own = set(load_configuration(stage).budget.seeds_of("lunar_lander"))
        assert min(own) >= 1_000_000
        for name in set(budgets()) - {stage}:
            assert not own & seeds[name], name


def test_calls_make_each_record_once_under_its_own_reading() -> None:
    asked = calls(SCREENING, list(candidates()))
    records = [word for line in asked for word in line.split() if word.endswith(".parquet")]
    assert len(records) == len(set(records)) == 87
    for line in asked:
        *paths, option, budget, reading = line.split()
        assert (option, budget) == ("--config", "budget=search")
        assert {Path(path).parts[1] for path in paths} == {reading.removeprefix("reading=")}
    shared = calls(CONFIRMATION, ["removal_rare_mutation"])
    assert [line.split()[-1] for line in shared] == [
        "reading=removal_rare_mutation",
        "reading=removal",
    ]
    (block, *_) = baseline_blocks("removal_rare_mutation", "neat_wo", CONFIRMATION)
    assert str(RESULTS / block.record) in shared[1]


@pytest.mark.parametrize(
    ("content", "expected"),
    [
        ("removal: {neat_w: first}", "search/mine.yaml: removal.neat_w: unknown key"),
        ("a: {neat_wo: removal}", "search/mine.yaml: a.neat_wo = removal: has no"),
        (
            "a: {}\nb: {neat_wo: a}\nc: {neat_wo: b}",
            "search/mine.yaml: c.neat_wo = b: has no runs of NEAT (w/o) of its own",
        ),
    ],
)
def test_a_list_that_is_not_allowed(
    content: str, expected: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    path = tmp_path / "search" / "mine.yaml"
    path.parent.mkdir()
    path.write_text(content)
    monkeypatch.setattr(search, "CANDIDATES", path)
    assert refusal(candidates).startswith(expected)


def test_a_reading_that_is_no_candidate() -> None:
    assert refusal(calls, SCREENING, ["frist"]).startswith('"frist" is not a candidate')
