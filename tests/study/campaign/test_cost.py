"""What runs cost, from measured values made up and shipped."""

import pytest

from benchmarks.scaling import comparison
from neol.spec.configuration import load_configuration
from neol.spec.run_spec import RunSpec
from neol.study.campaign.cost import run_seconds, shipped, walltime_minutes

MEASURED = {
    ("short_run", "hopper", "hebb"): 100.0,  # µs a step
    ("short_run_generations", "hopper", ""): 12.0,
    ("short_run_steps", "hopper", "hebb"): 500.0,
    ("short_run_late_steps", "hopper", "hebb"): 700.0,
    ("neat_generation", "hopper", ""): 9.0,  # ms, P = 300
}


def spec(task: str, **changed: int) -> RunSpec:
    arguments = {"population": 50, "generations": 8, "seed": 0} | changed
    configuration = load_configuration("paper")
    return configuration.run_spec(task=task, method="oja", learning_rate=0.25, **arguments)


def get(quantity: str, task: str, networks: str) -> float | None:
    return MEASURED.get((quantity, task, networks))


def test_a_run_costs_its_evaluations() -> None:
    usual, longest = (run_seconds(spec("hopper"), get, to_the_limit=limit) for limit in (0, 1))
    assert usual == pytest.approx(400 * (500 * 100e-6 + 30e-6))
    assert longest == pytest.approx(400 * (1000 * 100e-6 + 30e-6))
    assert run_seconds(spec("hopper", population=100), get) == pytest.approx(2 * usual)


def test_after_the_measured_generations_episodes_are_as_long_as_in_the_last_of_them() -> None:
    long = run_seconds(spec("hopper", generations=48), get)
    assert long == pytest.approx(12 * 50 * (500 * 100e-6) + 36 * 50 * (700 * 100e-6) + 2400 * 30e-6)


def test_what_was_never_measured_may_last_a_day() -> None:
    assert run_seconds(spec("gym:Acrobot-v1"), get) is None
    assert walltime_minutes(spec("gym:Acrobot-v1"), seeds=3) == 24 * 60
    assert 15 < walltime_minutes(spec("hopper"), seeds=30) < 24 * 60


def test_the_demo_s_records_cost_what_is_predicted() -> None:
    *_, whole = comparison(shipped, "demo").strip().splitlines()
    _, _, runs, _, _, ratio, _ = whole.split("|")
    assert int(runs) == 160
    assert 0.5 < float(ratio) < 2
