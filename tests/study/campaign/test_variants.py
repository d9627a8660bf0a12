"""Variants: what they run, and what is said of them."""

import math
from collections import Counter
from pathlib import Path
from typing import Any

import pytest
from ruamel.yaml import YAML

from neol.base.errors import UserError
from neol.run.record_file import write_record
from neol.spec.configuration import budgets, load_configuration
from neol.study.campaign import variants as study_of
from neol.study.campaign.jobs import jobs
from neol.study.campaign.shown import select
from neol.study.campaign.variants import BASELINE, STUDY, trials, variants
from neol.study.outcomes.sensitivity import sensitivity
from tests.helpers.made_up import run, write_trials
from tests.helpers.refusal import refusal

SMOKE = select("smoke")


@pytest.mark.parametrize("name", variants())
@pytest.mark.parametrize("reading", ["worked_example", "first"])
def test_a_variant_differs_from_the_baseline_in_what_it_says(reading: str, name: str) -> None:
    configuration = load_configuration("paper", reading=reading)
    baseline = {(each.task, each.method): each.spec for each in trials(configuration, BASELINE)}
    for trial in trials(configuration, name):
        same = trial.spec == baseline[trial.task, trial.method]
        assert same == (name == BASELINE)


@pytest.mark.parametrize(("reading", "same"), [("removal", "beta 1"), ("first", "beta 0.01")])
def test_what_a_reading_has_anyway_is_not_run(reading: str, same: str) -> None:
    for configuration in (
        load_configuration("demo", reading=reading),
        select("demo", "cartpole", reading),
    ):
        idle = [name for name in variants() if not trials(configuration, name)]
        assert idle == [same]


def test_the_seeds_are_none_of_the_budgets() -> None:
    for budget in budgets():
        configuration = load_configuration(budget)
        for trial in trials(configuration, BASELINE):
            seeds = configuration.budget.seeds_of(trial.task)
            assert not set(trial.seeds) & set(seeds)
            assert len(trial.seeds) == min(len(seeds), 10)


@pytest.mark.parametrize(
    ("budget", "task", "evaluations"),
    [
        ("demo", "cartpole", 250_000),
        ("paper", "lunar_lander", 250_000),
    ],
)
def test_the_study_costs_what_its_file_says(budget: str, task: str, evaluations: int) -> None:
    constants = load_configuration(budget)
    spent = [
        len(trial.seeds)
        * trial.spec.generations
        * trial.spec.population
        * trial.spec.evaluation.episodes
        for name in variants()
        for trial in trials(constants, name)
        if trial.task == task
    ]
    assert (len(spent), sum(spent)) == (21, evaluations)
    assert f"{evaluations:,}" in STUDY.read_text(encoding="utf-8")


def test_every_record_has_a_place_of_its_own() -> None:
    records = [trial.record for name in variants() for trial in trials(SMOKE, name)]
    assert len(set(records)) == len(records)


def test_an_unknown_variant_is_refused() -> None:
    with pytest.raises(UserError, match='unknown variant "beta 7"'):
        trials(SMOKE, "beta 7")


@pytest.mark.parametrize(
    ("name", "right", "wrong", "expected"),
    [
        ("STUDY", "seeds:", "sedes:", 'study.yaml: sedes: unknown key, did you mean "seeds"?'),
        ("STUDY", "population: 50", "population: 1", "study.yaml: population = 1: must be greater"),
        ("VARIANTS", "alpha 1: {methods", "alpha 1: {method", "alpha 1.method: unknown key, did"),
        ("VARIANTS", "[bcm]", "[bmc]", "variants.yaml: beta 0.001.methods.0 = 'bmc': must be"),
        ("VARIANTS", "[bcm]", "[]", "variants.yaml: beta 0.001.methods = []: must not be empty"),
        ("VARIANTS", "{methods: [bcm, neat], set: []}", "3", "variants.yaml: baseline = 3: must"),
        ("VARIANTS", "reward_scale", "scale", "beta 0.001.set: --set: plasticity.scale: unknown"),
    ],
)
def test_a_mistake_in_a_file_is_one_line(
    name: str,
    right: str,
    wrong: str,
    expected: str,
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    file: Path = getattr(study_of, name)
    broken = tmp_path / "sensitivity" / file.name
    broken.parent.mkdir()
    broken.write_text(file.read_text().replace(right, wrong))
    monkeypatch.setattr(study_of, name, broken)
    line = refusal(lambda: list(jobs(SMOKE)))
    assert line.startswith(f"sensitivity/{file.name}: ")
    assert expected in line


def test_no_file_is_parsed_twice(monkeypatch: pytest.MonkeyPatch) -> None:
    parsed: Counter[str] = Counter()
    load = YAML.load

    def counted(self: YAML, text: str) -> Any:
        parsed[text] += 1
        return load(self, text)

    monkeypatch.setattr(YAML, "load", counted)
    list(jobs(SMOKE))
    assert set(parsed.values()) <= {1}


def test_a_trial_of_other_seeds_is_refused(tmp_path: Path) -> None:
    write_trials(tmp_path, SMOKE, {BASELINE: 0.0})
    (trial, *_) = trials(SMOKE, BASELINE)
    path = tmp_path / trial.record
    write_record(path, run(trial.spec, SMOKE.budget.name, 0.0))
    with pytest.raises(UserError, match=f"{path.name}: does not hold seeds 1000000 to 1000002"):
        sensitivity(SMOKE, tmp_path)


def test_the_effect_of_a_variant(tmp_path: Path) -> None:
    """With ReLU every run ends 10 higher; nothing else was run."""
    write_trials(tmp_path, SMOKE, {BASELINE: 0.0, "ReLU": 10.0})
    table, sources = sensitivity(SMOKE, tmp_path)
    rows = table.set_index(["variant", "task", "method"])
    assert rows.loc[("ReLU", "lunar_lander", "neat"), "a12"] == 1
    assert (
        rows.loc[("ReLU", "lunar_lander", "bcm"), "mean"] == 10
    )  # held-out: 1 less than in training
    assert rows.loc[("ReLU", "lunar_lander", "bcm"), "difference"] == 10
    same = rows.loc[(BASELINE, "lunar_lander", "bcm")]
    assert (same["a12"], same["low"], same["high"]) == (0.5, 0.5, 0.5)  # runs are paired by seed
    assert (same["same"], rows.loc[("ReLU", "lunar_lander", "bcm"), "same"]) == (3, 0)
    assert math.isnan(rows.loc[("sigmoid", "lunar_lander", "bcm"), "mean"])
    assert len(sources) == 2 * 4
