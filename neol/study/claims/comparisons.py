"""The kinds of test that decide a claim, each an effect of the runs of some cells.

An effect is signed so that the claim says "greater than 0". A test has one part for each task and
method (or cell) that it speaks of; the claim says that all of them hold.
"""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from itertools import product
from typing import Annotated, Literal

import numpy as np
from pydantic import Field

from neol.spec.types import Model
from neol.study.campaign.grid import Cell
from neol.study.claims.judgement import DecisionRule, by_interval, by_rank_sum
from neol.study.outcomes import statistics
from neol.study.outcomes.outcomes import METRICS, Metric, Outcomes, Setting
from neol.study.outcomes.statistics import Effect, Floats

Methods = tuple[Literal["bcm", "hebb", "oja", "neat", "neat_wo"], ...]

DIFFERENCES: dict[str, Effect] = {
    "mean": statistics.mean_difference,
    "median": statistics.median_difference,
    "sd": statistics.sd_difference,
    "iqr": statistics.iqr_difference,
    "low_outliers": statistics.outlier_difference,
}


@dataclass(frozen=True)
class Part:
    """One thing that a claim says."""

    label: str
    unit: str
    """Of the effect."""
    cells: tuple[Cell | None, ...]
    """Whose runs it is made of; None for one that the budget does not have."""
    metric: Metric
    rule: DecisionRule
    """What decides it, given the cells' values in their order."""
    among: tuple[Cell, ...] = ()
    """What the cells were chosen among: a seed that is missing there could change the choice."""
    provisional: Literal["supported", "contradicted"] | None = None
    """The verdict that more generations could overturn: fewer than the paper's do not give it."""


class Pairing(Model):
    """Methods against another method on some tasks, each in its cell of a setting."""

    metric: Metric
    setting: Setting
    tasks: tuple[str, ...]
    methods: Methods
    against: str


class Compare(Pairing):
    """A statistic of each method against another method, each in its cell of a setting."""

    kind: Literal["compare"]
    statistic: Literal["mean", "median", "sd", "iqr", "low_outliers"]
    direction: Literal["higher", "lower"]

    def parts(self, outcomes: Outcomes) -> Iterator[Part]:
        """One for each task and method."""
        effect = signed(DIFFERENCES[self.statistic], self.direction)
        outliers = self.statistic == "low_outliers"
        for task, method in product(self.tasks, self.methods):
            unit = METRICS[self.metric]
            unit = f"share of runs, {unit}" if outliers else unit
            cells, among = chosen(outcomes, self.setting, task, (method, self.against))
            label = f"{task}: {self.statistic} of {method} {self.direction} than {self.against}"
            yield Part(label, unit, cells, self.metric, by_interval(effect), among)


class Significant(Pairing):
    """Each method's one-sided rank-sum test against another method."""

    kind: Literal["significant", "not_significant"]

    def parts(self, outcomes: Outcomes) -> Iterator[Part]:
        """One for each task and method."""
        for task, method in product(self.tasks, self.methods):
            cells, among = chosen(outcomes, self.setting, task, (method, self.against))
            yield Part(
                label=f"{task}: {method} over {self.against} {self.kind.replace('_', ' ')}",
                unit=f"A12 - 0.5, {METRICS[self.metric]}",
                cells=cells,
                metric=self.metric,
                rule=by_rank_sum(differs=self.kind == "significant"),
                among=among,
            )


class Rank(Model):
    """A method's mean is among the highest so many of several methods'."""

    kind: Literal["rank"]
    at_most: Annotated[int, Field(ge=1)]
    metric: Metric
    setting: Setting
    tasks: tuple[str, ...]
    method: str
    among: Methods

    def parts(self, outcomes: Outcomes) -> Iterator[Part]:
        """One for each task: the lead over the best of those that must lie below."""

        def lead(sample: Floats, *others: Floats) -> Floats:
            means = np.sort([other.mean(axis=-1) for other in others], axis=0)
            return np.asarray(sample.mean(axis=-1) - means[-self.at_most])

        others = [method for method in self.among if method != self.method]
        for task in self.tasks:
            cells, among = chosen(outcomes, self.setting, task, (self.method, *others))
            label = f"{task}: {self.method} among the best {self.at_most}"
            # Who shares the first place is second at least, but does not lead.
            rule = by_interval(lead, at_least=self.at_most > 1)
            yield Part(label, METRICS[self.metric], cells, self.metric, rule, among)


class Gain(Model):
    """The relative gain in the mean over another method is larger on some tasks than on others."""

    kind: Literal["larger_gain"]
    metric: Metric
    setting: Setting
    tasks: tuple[str, ...]
    than_tasks: tuple[str, ...]
    methods: Methods
    against: str

    def parts(self, outcomes: Outcomes) -> Iterator[Part]:
        """One for each method."""

        def gain(samples: Sequence[Floats]) -> Floats:
            pairs = zip(samples[::2], samples[1::2], strict=True)
            means = [(sample.mean(axis=-1), against.mean(axis=-1)) for sample, against in pairs]
            return np.asarray(
                np.mean([(ours - theirs) / abs(theirs) for ours, theirs in means], axis=0)
            )

        def difference(*samples: Floats) -> Floats:
            split = 2 * len(self.tasks)
            return gain(samples[:split]) - gain(samples[split:])

        for method in self.methods:
            pairs = [
                chosen(outcomes, self.setting, task, (method, self.against))
                for task in (*self.tasks, *self.than_tasks)
            ]
            cells = tuple(cell for pair, _ in pairs for cell in pair)
            among = tuple(cell for _, candidates in pairs for cell in candidates)
            tasks, others = ", ".join(self.tasks), ", ".join(self.than_tasks)
            label = f"{method}: gain on {tasks} over that on {others}"
            unit = f"relative gain, {METRICS[self.metric]}"
            yield Part(label, unit, cells, self.metric, by_interval(difference), among)


def chosen(
    outcomes: Outcomes, setting: Setting, task: str, methods: Sequence[str]
) -> tuple[tuple[Cell | None, ...], tuple[Cell, ...]]:
    """The cells that stand for some methods on a task, and all that they were chosen among."""
    among = [outcomes.candidates[setting].get((task, method), []) for method in methods]
    cells = tuple(outcomes.chosen(setting, task, method) for method in methods)
    return cells, tuple(cell for some in among for cell in some)


def signed(effect: Effect, direction: Literal["higher", "lower"]) -> Effect:
    return effect if direction == "higher" else lambda *samples: -effect(*samples)
