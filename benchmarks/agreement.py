"""Our NEAT beside neat-python 0.92, both with our engine: `make agreement`.

Runs both, writes docs/neat-python.csv, and prints how they compare. docs/neat-python.md says what
is compared; it stated the margins before the first run.
"""

import importlib.metadata
import math
import platform
import sys
from collections.abc import Iterator
from io import StringIO
from pathlib import Path
from typing import NamedTuple

import numpy as np
import pandas as pd

from neol.base.errors import UserError
from neol.base.files import write_atomically
from neol.rollout import Engine, make_engine
from neol.rollout.environment import network_size
from neol.run.evolution import Evolution
from neol.spec.configuration import ROOT, load_configuration
from neol.spec.run_spec import RunSpec
from neol.study.outcomes.contrasts import Moments, difference
from neol.study.outcomes.statistics import Floats

OUTPUT = ROOT / "docs" / "neat-python.csv"
OURS, LIBRARY = "neol", "neat-python"
POPULATION, GENERATIONS, STRETCH = 50, 40, 10


class Comparison(NamedTuple):
    """Runs of both sides with the same constants."""

    reading: str
    first_seeds: dict[str, int]
    """First seed of each side."""
    seeds: dict[str, int]
    """Number of seeds, by task."""


SWITCHES = "+neat.distance=all_genes+neat.equal_parents=random+neat.innovation=endpoints"
COMPARISONS = {
    "first": Comparison(
        "neat_python",
        {OURS: 1_005_000, LIBRARY: 1_006_000},
        {"cartpole": 30, "lunar_lander": 20},
    ),
    "second": Comparison(
        f"neat_python{SWITCHES}",
        {OURS: 1_007_000, LIBRARY: 1_008_000},
        {"cartpole": 30, "lunar_lander": 60},
    ),
}
COLUMNS = {
    "best_fitness": "best fitness",
    "mean_fitness": "mean fitness",
    "species": "species",
    "nodes_mean": "hidden and output nodes",
    "connections_mean": "enabled connections",
}
"""Compared columns of a record, and their names."""
FITNESS_MARGIN = {"cartpole": 50.0, "lunar_lander": 40.0}
"""Largest difference of mean fitness that counts as agreement."""
RATIO_MARGIN = 1.25
"""Ratio of mean numbers of species, nodes and connections that is small enough, either way."""
CONFIDENCE = 0.90
"""Level of the interval that must lie within the margins: two one-sided tests at 5%."""


class Agreement(NamedTuple):
    """Comparison of one quantity: differences for fitness, ratios for counts."""

    task: str
    quantity: str
    generations: str
    ours: float
    library: float
    difference: float
    low: float
    high: float
    margin: float

    @property
    def equivalent(self) -> bool:
        """Whether the interval lies within the margins."""
        below = 1 / self.margin if self.quantity not in FITNESS else -self.margin
        return below < self.low and self.high < self.margin


FITNESS = tuple(COLUMNS)[:2]
KEYS = ["comparison", "evolves", "task", "seed", "until"]
"""Keys of a row; `until` is the last of its ten generations."""


def run_spec(reading: str, task: str, seed: int) -> RunSpec:
    """Return the specification of NEAT with the library's constants."""
    return load_configuration(reading=reading).run_spec(
        task=task, method="neat", population=POPULATION, generations=GENERATIONS, seed=seed
    )


def our_generations(spec: RunSpec, engine: Engine) -> Iterator[tuple[float, ...]]:
    """Run our NEAT; yield the compared quantities of each generation."""
    for row in Evolution.begin(spec, *network_size(spec.task)).run(engine):
        yield tuple(getattr(row, column) for column in COLUMNS)


def run_all(name: str) -> pd.DataFrame:
    """The runs of a comparison, a row for each ten generations of a run.

    The columns `KEYS`, and the means of `COLUMNS` over the ten generations.
    """
    from benchmarks import library

    reading, first_seeds, counts = COMPARISONS[name]
    rows = []
    for task, seeds in counts.items():
        engine = make_engine(run_spec(reading, task, 0).task)
        for side, first in first_seeds.items():
            evolve = our_generations if side == OURS else library.evolve
            for seed in range(first, first + seeds):
                values = np.array(list(evolve(run_spec(reading, task, seed), engine)))
                means = values.reshape(-1, STRETCH, len(COLUMNS)).mean(axis=1)
                ends = range(STRETCH, GENERATIONS + 1, STRETCH)
                rows += [
                    (name, side, task, seed, end, *mean.tolist())
                    for end, mean in zip(ends, means, strict=True)
                ]
            print(f"{name}, {task}: {seeds} runs of {side}", file=sys.stderr, flush=True)
        engine.close()
    return pd.DataFrame(rows, columns=[*KEYS, *COLUMNS])


def judge(runs: pd.DataFrame) -> list[Agreement]:
    """Each quantity's mean over all generations, and over the last ten, compared over runs."""
    found = []
    for task in dict.fromkeys(runs["task"]):
        for after, name in ((0, "all"), (GENERATIONS - STRETCH, f"last {STRETCH}")):
            there = runs[(runs["task"] == task) & (runs["until"] > after)]
            of_runs = there.groupby(["evolves", "seed"])[list(COLUMNS)].mean()
            for column in COLUMNS:
                samples = [of_runs.loc[side, column].to_numpy() for side in (OURS, LIBRARY)]
                found.append(_compare(task, column, name, *samples))
    return found


def _compare(task: str, column: str, generations: str, ours: Floats, library: Floats) -> Agreement:
    means = float(ours.mean()), float(library.mean())
    if column in FITNESS:
        found = difference(Moments.of(ours), Moments.of(library))
        low, high = found.interval(CONFIDENCE)
        margin = FITNESS_MARGIN[task]
        return Agreement(task, column, generations, *means, found.value, low, high, margin)
    found = difference(Moments.of(np.log(ours)), Moments.of(np.log(library)))
    low, high = np.exp(found.interval(CONFIDENCE))
    ratio = math.exp(found.value)
    return Agreement(task, column, generations, *means, ratio, low, high, RATIO_MARGIN)


def table(found: list[Agreement]) -> str:
    """The comparison as a Markdown table."""
    lines = [
        "| task | mean over generations | of | neol | neat-python | difference or ratio "
        "| 90% interval | within | |",
        "|" + " --- |" * 9,
    ]
    for each in found:
        fitness = each.quantity in FITNESS
        digits = 1 if fitness else 2
        within = f"± {each.margin:.0f}" if fitness else f"{1 / each.margin:.2f} to {each.margin}"
        numbers = [f"{value:.{digits}f}" for value in each[3:6]]
        interval = f"{each.low:.{digits}f} to {each.high:.{digits}f}"
        verdict = "equivalent" if each.equivalent else "**not shown to be**"
        words = [each.task, COLUMNS[each.quantity], each.generations, *numbers, interval]
        lines.append("| " + " | ".join([*words, within, verdict]) + " |")
    return "\n".join(lines) + "\n"


def write(runs: pd.DataFrame, path: Path = OUTPUT) -> None:
    """Write all rows after lines on their provenance."""
    packages = ("neat-python", "numpy", "gymnasium")
    versions = ", ".join(f"{name} {importlib.metadata.version(name)}" for name in packages)
    text = StringIO()
    text.write("# made by: make agreement\n")
    text.write(f"# with: {versions}, Python {platform.python_version()}\n")
    runs.to_csv(text, index=False, float_format="%.6g", lineterminator="\n")
    write_atomically(path, text.getvalue().encode())


def read(path: Path = OUTPUT) -> pd.DataFrame:
    """Read what `write` has written."""
    return pd.read_csv(path, comment="#")


if __name__ == "__main__":
    try:
        write(pd.concat([run_all(name) for name in COMPARISONS], ignore_index=True))
    except UserError as error:
        sys.exit(f"agreement: {error}")
    for comparison, rows in read().groupby("comparison"):
        print(f"{comparison}:\n{table(judge(rows))}")
