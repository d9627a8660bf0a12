"""The kinds of test that look at a method's whole grid of populations and learning rates."""

from collections.abc import Iterable, Iterator, Sequence
from itertools import combinations, product
from typing import Annotated, Literal

import numpy as np
from pydantic import Field

from neol.spec.types import Model
from neol.study.campaign.grid import Cell
from neol.study.claims.comparisons import Methods, Part, chosen, signed
from neol.study.claims.judgement import by_interval, by_one_run, by_share
from neol.study.outcomes.outcomes import EQUAL, METRICS, Metric, Outcomes, Setting
from neol.study.outcomes.statistics import Floats, mean_difference, superiority

Size = int | Literal["smallest", "largest"]
Rate = float | Literal["smallest", "largest"]


class Where(Model):
    """Part of a method's grid; what is not named is not restricted."""

    populations: tuple[Size, ...] | None = None
    learning_rates: tuple[Rate, ...] | None = None

    def of(self, cells: Sequence[Cell]) -> list[Cell]:
        """Those of the cells that lie there; none at all where one that is named is not there."""
        sizes = _named(self.populations, [cell.population for cell in cells])
        rates = _named(self.learning_rates, [cell.learning_rate for cell in cells])
        if sizes is None or rates is None:
            return []
        return [cell for cell in cells if cell.population in sizes and cell.learning_rate in rates]


class Level(Model):
    """The mean is at least so high, or below that, in a setting or in cells of the grid."""

    kind: Literal["level"]
    metric: Metric
    bound: Literal["at_least", "below"]
    level: float
    maximum: bool = False
    """Whether no run can be above the level."""
    tasks: tuple[str, ...]
    methods: Methods
    setting: Setting | None = None
    where: Where = Where()

    def parts(self, outcomes: Outcomes) -> Iterator[Part]:
        """One for each cell."""
        reaches = self.bound == "at_least"

        def distance(sample: Floats) -> Floats:
            return np.asarray((sample.mean(axis=-1) - self.level) * (1 if reaches else -1))

        for task, method in product(self.tasks, self.methods):
            cells: Sequence[Cell | None]
            if self.setting:
                cells, among = chosen(outcomes, self.setting, task, [method])
            else:
                cells, among = self.where.of(outcomes.grid(task, [method])) or [None], ()
            for cell in cells:
                bound = self.bound.replace("_", " ")
                yield Part(
                    label=f"{task}: {_cell(method, cell)} {bound} {self.level:g}",
                    unit=METRICS[self.metric],
                    cells=(cell,),
                    metric=self.metric,
                    rule=by_one_run(distance, reaches=reaches)
                    if self.maximum
                    else by_interval(distance, at_least=reaches),
                    among=among,
                    provisional="contradicted" if reaches else "supported",
                )


class Share(Model):
    """In more than this share of its cells a method's mean is higher (lower) than another's."""

    kind: Literal["share"]
    more_than: Annotated[float, Field(ge=0, lt=1)]
    direction: Literal["higher", "lower"]
    metric: Metric
    tasks: tuple[str, ...]
    methods: Methods
    against: str

    def parts(self, outcomes: Outcomes) -> Iterator[Part]:
        """One for each task and method; cells of one population (and rate) are compared."""

        for task, method in product(self.tasks, self.methods):
            there = {
                (cell.population, cell.learning_rate): cell
                for cell in outcomes.grid(task, [self.against])
            }
            cells: list[Cell | None] = []
            for cell in outcomes.grid(task, [method]):
                same_rate = there.get((cell.population, cell.learning_rate))
                pair = [cell, same_rate or there.get((cell.population, None))]
                cells += pair if self.direction == "higher" else reversed(pair)
            label = (
                f"{task}: {method} {self.direction} than {self.against} "
                f"in more than {self.more_than:.0%} of its cells"
            )
            unit = f"share of cells above {self.more_than:.0%}, {METRICS[self.metric]}"
            found = tuple(cells) or (None,)
            yield Part(label, unit, found, self.metric, by_share(self.more_than))


class Trend(Model):
    """Runs tend to larger (smaller) values along an axis of the grid, the other axis held fixed."""

    kind: Literal["trend"]
    along: Literal["population", "learning_rate"]
    direction: Literal["up", "down"]
    metric: Metric
    tasks: tuple[str, ...]
    methods: Methods
    where: Where = Where()

    def parts(self, outcomes: Outcomes) -> Iterator[Part]:
        """One for each task and method: A12 - 1/2, averaged over all pairs of cells in line."""
        for task, method in product(self.tasks, self.methods):
            cells = self.where.of(outcomes.grid(task, [method]))
            pairs = [
                pair for pair in combinations(range(len(cells)), 2) if self._in_line(cells, pair)
            ]

            def trend(*samples: Floats, pairs: list[tuple[int, int]] = pairs) -> Floats:
                steps = [
                    superiority(samples[larger], samples[smaller]) for smaller, larger in pairs
                ]
                return np.asarray(np.mean(steps, axis=0) - 0.5)

            label = (
                f"{task}: {method} goes {self.direction} with the {self.along.replace('_', ' ')}"
            )
            found = tuple(cells) if pairs else (None,)
            effect = signed(trend, "higher" if self.direction == "up" else "lower")
            unit = f"A12 - 0.5, {METRICS[self.metric]}"
            yield Part(
                label,
                unit,
                found,
                self.metric,
                by_interval(effect),
                provisional=_of_sizes(self.metric) if self.along == "population" else None,
            )

    def _in_line(self, cells: Sequence[Cell], pair: tuple[int, int]) -> bool:
        first, second = (cells[index] for index in pair)
        if self.along == "population":
            same = first.learning_rate == second.learning_rate
            return same and first.population < second.population
        rates = first.learning_rate or 0.0, second.learning_rate or 0.0
        return first.population == second.population and rates[0] < rates[1]


class Peak(Model):
    """The highest mean of some cells lies above the highest of others, by more than a margin."""

    kind: Literal["peak"]
    metric: Metric
    tasks: tuple[str, ...]
    methods: Methods
    where: Where = Where()
    against: Methods | None = None
    """The others: all cells of these methods; otherwise the method's own outside of `where`."""
    margin: float = 0.0
    intermediate: bool = False
    """Whether the method must have learning rates both below and above those of `where`."""

    def parts(self, outcomes: Outcomes) -> Iterator[Part]:
        """One for each task and method: the lead of the one highest cell over the other."""

        def lead(sample: Floats, against: Floats) -> Floats:
            return mean_difference(sample, against) - self.margin

        for task, method in product(self.tasks, self.methods):
            own = outcomes.grid(task, [method])
            inside = self.where.of(own)
            others = outcomes.grid(task, self.against) if self.against else own
            outside = [cell for cell in others if cell not in inside]

            enclosed = not self.intermediate or _enclosed(inside, own)
            found = bool(inside and outside and enclosed)
            pair = [_highest(outcomes, half, self.metric) for half in (inside, outside) if found]
            label = (
                f"{task}: the best of {_where(method, self.where)} above that of {_others(self)}"
            )
            yield Part(
                label=label,
                unit=METRICS[self.metric],
                cells=tuple(pair) or (None,),
                metric=self.metric,
                rule=by_interval(lead, picked=(len(inside), len(outside))),
                among=(*inside, *outside) if found else (),
                provisional=self._provisional(),
            )

    def _provisional(self) -> Literal["contradicted"] | None:
        """What more generations could overturn: a lead of so much is a level, not yet reached."""
        if self.margin:
            return "contradicted"
        return _of_sizes(self.metric) if self.where.populations else None


class Sensitivity(Model):
    """A method's means differ more between learning rates than those of each of some others."""

    kind: Literal["sensitivity"]
    metric: Metric
    tasks: tuple[str, ...]
    method: str
    than: Methods

    def parts(self, outcomes: Outcomes) -> Iterator[Part]:
        """One for each task and other method: the range over rates, averaged over populations."""
        for task, other in product(self.tasks, self.than):
            rows = [
                _by_population(outcomes.grid(task, [method])) for method in (self.method, other)
            ]

            def difference(*samples: Floats, rows: list[list[list[Cell]]] = rows) -> Floats:
                remaining = iter(samples)
                spreads = []
                for grid in rows:
                    means = [[next(remaining).mean(axis=-1) for _ in row] for row in grid]
                    spreads.append(np.mean([np.ptp(row, axis=0) for row in means], axis=0))
                return np.asarray(spreads[0] - spreads[1])

            cells = tuple(cell for grid in rows for row in grid for cell in row)
            several = cells and all(len(row) > 1 for grid in rows for row in grid)
            label = f"{task}: {self.method} depends on the learning rate more than {other}"
            found = cells if several else (None,)
            unit = METRICS[self.metric]
            yield Part(label, unit, found, self.metric, by_interval(difference))


def _named(
    names: Sequence[float | str] | None, present: Sequence[float | None]
) -> set[float | None] | None:
    """The values that are meant, "smallest" and "largest" among those present.

    None if one of them is not present. Without names all are meant.
    """
    if names is None:
        return set(present)
    values = [value for value in present if value is not None]
    extremes = {"smallest": min(values, default=None), "largest": max(values, default=None)}
    meant = {extremes[name] if isinstance(name, str) else name for name in names}
    return meant if meant <= set(values) else None


def _of_sizes(metric: str) -> Literal["contradicted"] | None:
    """What more generations could overturn where population sizes are compared.

    At equal cost, what large populations have spent first is not yet much for them. And SCORE has
    the size as a factor, so that it falls with it as long as fitness is below 0.
    """
    return "contradicted" if metric in (*EQUAL, "score") else None


def _highest(outcomes: Outcomes, cells: Sequence[Cell], metric: str) -> Cell:
    """The cell with the highest mean; the first one if none has runs."""
    return max(cells, key=lambda cell: np.nan_to_num(outcomes.mean(cell, metric), nan=-np.inf))


def _enclosed(inside: Sequence[Cell], cells: Sequence[Cell]) -> bool:
    """Whether some cells have learning rates below and above all of those inside."""
    rates = [cell.learning_rate or 0.0 for cell in cells]
    within = [cell.learning_rate or 0.0 for cell in inside]
    return bool(within) and min(rates) < min(within) and max(rates) > max(within)


def _by_population(cells: Iterable[Cell]) -> list[list[Cell]]:
    rows: dict[int, list[Cell]] = {}
    for cell in cells:
        rows.setdefault(cell.population, []).append(cell)
    return list(rows.values())


def _cell(method: str, cell: Cell | None) -> str:
    if cell is None:
        return method
    rate = "" if cell.learning_rate is None else f", lr={cell.learning_rate:g}"
    return f"{method} (pop={cell.population}{rate})"


def _where(method: str, where: Where) -> str:
    limits = []
    if where.populations:
        limits.append(f"pop={' or '.join(map(str, where.populations))}")
    if where.learning_rates:
        limits.append(f"lr={' or '.join(map(str, where.learning_rates))}")
    return f"{method} ({', '.join(limits)})" if limits else method


def _others(peak: Peak) -> str:
    others = ", ".join(peak.against) if peak.against else "its other cells"
    return f"{others} by more than {peak.margin:g}" if peak.margin else others
