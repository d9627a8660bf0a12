"""Claims about made-up runs, whose answer is known."""

from collections.abc import Sequence
from typing import Any

import pandas as pd

from neol.spec.configuration import load_configuration
from neol.study.campaign.grid import Cell
from neol.study.claims.claims import Claim, Decision, decide
from neol.study.outcomes.outcomes import METRICS, Outcomes

Values = dict[Cell, Sequence[float]]
Test = dict[str, Any]
NOISE = (-2.0, -1.0, -0.5, 0.0, 0.0, 0.5, 1.0, 2.0)
"""Eight seeds around their mean."""


def cell(method: str, population: int = 6, rate: float | None = 0.1, task: str = "hopper") -> Cell:
    return Cell(task, method, population, None if method.startswith("neat") else rate)


def around(mean: float, factor: float = 1.0) -> list[float]:
    return [mean + factor * each for each in NOISE]


def outcomes(values: Values, seeds: int = 8, generations: int | dict[str, int] = 500) -> Outcomes:
    """All metrics have the same values; every setting chooses among a method's cells."""
    rows = [
        (each.task, each.method, each.population, each.learning_rate, seed, *[value] * len(METRICS))
        for each, runs in values.items()
        for seed, value in enumerate(runs)
    ]
    columns = ["task", "method", "population", "learning_rate", "seed", *METRICS]
    candidates: dict[tuple[str, str], list[Cell]] = {}
    for each in values:
        candidates.setdefault((each.task, each.method), []).append(each)
    spent_by_generation = (10, 20)  # with the same best fitness
    histories = {
        each: pd.DataFrame(
            [
                (seed, value, spent, spent)
                for seed, value in enumerate(runs)
                for spent in spent_by_generation
            ],
            columns=["seed", "best_fitness", "evaluations", "env_steps"],
        )
        for each, runs in values.items()
    }
    return Outcomes(
        pd.DataFrame(rows, columns=columns).astype({"learning_rate": float}),
        tuple(values),
        dict.fromkeys(("table3", "table4", "score"), candidates),
        load_configuration("paper").budget.model_copy(
            update={"seeds": seeds, "generations": generations}
        ),
        histories,
    )


def claim(**test: Any) -> Claim:
    test = {"metric": "final_best", "tasks": ["hopper"]} | test
    if test["kind"] in ("compare", "significant", "not_significant", "rank", "larger_gain"):
        test = {"setting": "table3"} | test
    content = {"id": "made-up", "place": "here", "quote": "...", "tests": [test]}
    return Claim.model_validate(content, strict=False)


def decision(
    values: Values, *, seeds: int = 8, generations: int | dict[str, int] = 500, **test: Any
) -> Decision:
    return decide(claim(**test), outcomes(values, seeds, generations))


def verdict(values: Values, **test: Any) -> str:
    return decision(values, **test).verdict


HIGHER: Test = {
    "kind": "compare",
    "statistic": "mean",
    "direction": "higher",
    "methods": ["bcm"],
    "against": "neat",
}
