"""What runs cost, from measured values made up and shipped."""

import pytest

from benchmarks.scaling import comparison
from neol.spec.configuration import load_configuration
from neol.spec.run_spec import RunSpec
from neol.study.campaign import cost
from neol.study.campaign.cost import (
    run_seconds,
    shipped,
    steps_of_an_evaluation,
    walltime_minutes,
)

MEASURED = {
    ("short_run", "hopper", "hebb"): 100.0,  # µs a step
    ("neat_generation", "hopper", ""): 9.0,  # ms, P = 300
}
LENGTHS = {"hopper": {"oja": {1: 100.0, 4: 250.0, 8: 500.0}, "neat": {1: 30.0, 8: 30.0}}}


@pytest.fixture
def made_up_lengths(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(cost, "recorded_lengths", lambda: LENGTHS)


def spec(task: str, **changed: int) -> RunSpec:
    arguments = {"population": 50, "generations": 8, "seed": 0} | changed
    configuration = load_configuration("paper")
    return configuration.run_spec(task=task, method="oja", learning_rate=0.25, **arguments)


def get(quantity: str, task: str, networks: str) -> float | None:
    return MEASURED.get((quantity, task, networks))


@pytest.mark.usefixtures("made_up_lengths")
def test_a_run_costs_its_evaluations() -> None:
    usual, longest = (run_seconds(spec("hopper"), get, to_the_limit=limit) for limit in (0, 1))
    assert usual == pytest.approx(400 * (500 * 100e-6 + 30e-6))
    assert longest == pytest.approx(400 * (1000 * 100e-6 + 30e-6))
    assert run_seconds(spec("hopper", population=100), get) == pytest.approx(2 * usual)


@pytest.mark.usefixtures("made_up_lengths")
def test_between_recorded_generations_episodes_grow_evenly() -> None:
    assert steps_of_an_evaluation("hopper", "oja", 1) == 100.0
    assert steps_of_an_evaluation("hopper", "oja", 4) == 250.0
    assert steps_of_an_evaluation("hopper", "oja", 6) == pytest.approx((4 * 250 + 8 * 500) / 2 / 6)


@pytest.mark.usefixtures("made_up_lengths")
def test_after_them_episodes_are_as_long_as_in_the_last_of_them() -> None:
    late = (8 * 500 - 4 * 250) / 4
    assert steps_of_an_evaluation("hopper", "oja", 48) == pytest.approx((4000 + 40 * late) / 48)


@pytest.mark.usefixtures("made_up_lengths")
def test_a_method_without_records_is_like_the_others() -> None:
    assert steps_of_an_evaluation("hopper", "hebb_mutated", 8) == (500 + 30) / 2
    assert steps_of_an_evaluation("gym:Acrobot-v1", "oja", 8) is None


def test_what_was_never_measured_may_last_a_day() -> None:
    assert run_seconds(spec("gym:Acrobot-v1"), get) is None
    assert walltime_minutes(spec("gym:Acrobot-v1"), seeds=3) == 24 * 60
    assert 15 < walltime_minutes(spec("hopper"), seeds=30) < 24 * 60


def test_the_shipped_records_of_demo_cost_what_is_predicted() -> None:
    *_, whole = comparison(shipped, "demo").strip().splitlines()
    _, _, runs, _, _, ratio, _ = whole.split("|")
    assert int(runs) == 160
    assert 0.5 < float(ratio) < 2
