"""Calibration of the ledger: made-up studies of known truth through the whole chain of verdicts.

A study has all cells of the paper's budget with 30 seeds, each run drawn from a normal
distribution, and is asked at each look. `python -m neol.study.claims.calibration` writes the table
of docs/explanation/verdicts.md.
"""

import argparse
from collections import Counter
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from itertools import islice
from pathlib import Path

import numpy as np
import pandas as pd

from neol.base.files import read_bounded, replace_between, write_atomically
from neol.spec.configuration import ROOT, load_configuration
from neol.study.campaign.grid import Cell, cells
from neol.study.claims.answers import Answer, answers
from neol.study.claims.ledger import PAPERS_WORDS
from neol.study.claims.looks import LOOKS
from neol.study.claims.questions import RULES, load_questions
from neol.study.claims.verdicts import AGAINST, FOR, UNASKED, Verdict
from neol.study.outcomes.outcomes import METRICS, Outcomes
from neol.study.outcomes.paper_numbers import PRINTED_IN, values
from neol.study.outcomes.statistics import Floats

PAGE = ROOT / "docs" / "explanation" / "verdicts.md"
BEGIN, END = "<!-- calibration: begin -->\n", "<!-- calibration: end -->\n"
TRUTHS = {
    "null": "every method is NEAT",
    "shift": "every rule is one standard deviation above NEAT and NEAT (w/o)",
    "one better": "BCM is one standard deviation above all others, which are alike",
    "rates": "every rule's means differ between learning rates, alike for all rules",
    "paper": "every cell has the mean and the deviation that the paper prints for its method",
}
"""Made-up worlds; NEAT's means and deviations are the paper's."""
MIDDLE_RATE = 0.01
"""Between the two lower and the two higher learning rates of the grid."""
COLUMNS = ("support", "reproduced", "contradiction", "open")
SUPPORT: tuple[Verdict, ...] = (*FOR, "mixed")


@dataclass(frozen=True)
class MadeUp(Outcomes):
    """Runs drawn from normal distributions, of which each cell has the first `available`."""

    drawn: Mapping[tuple[Cell, str], Floats] = field(default_factory=dict)
    available: int = LOOKS[-1]
    by_method: Mapping[tuple[str, str], list[Cell]] = field(default_factory=dict)

    def samples(self, compared: Sequence[Cell], metric: str) -> list[Floats]:
        """Return the runs of some cells, by seed."""
        return [self.drawn[cell, metric][: self.available] for cell in compared]

    def leading(self, cell: Cell) -> int:
        """Return `available` for every cell."""
        return self.available if (cell, "score") in self.drawn else 0

    def grid(self, task: str, methods: Iterable[str]) -> list[Cell]:
        """Return all cells of a task and some methods."""
        return [cell for method in methods for cell in self.by_method.get((task, method), ())]


def made_up_studies(truth: str, seed: int = 0) -> Iterator[MadeUp]:
    """Draw one study after another, each with all its seeds."""
    random = np.random.default_rng(seed)
    configuration = load_configuration("paper")
    by_method: dict[tuple[str, str], list[Cell]] = {}
    for cell in cells(configuration):
        by_method.setdefault((cell.task, cell.method), []).append(cell)
    grid = tuple(cells(configuration))
    means = {(cell, metric): _truth(truth, cell, metric) for cell in grid for metric in METRICS}
    while True:
        noise = random.standard_normal((len(means), LOOKS[-1]))
        drawn = {
            place: mean + sd * each
            for (place, (mean, sd)), each in zip(means.items(), noise, strict=True)
        }
        budget = configuration.budget
        yield MadeUp(pd.DataFrame(), grid, {}, budget, drawn=drawn, by_method=by_method)


def simulated(truth: str, studies: int, seed: int = 0) -> Iterator[list[tuple[Answer, ...]]]:
    """Answer the questions of `studies` made-up studies, of each at every look."""
    questions = load_questions()
    for study in islice(made_up_studies(truth, seed), studies):
        yield [answers(questions, replace(study, available=seeds)) for seeds in LOOKS]


def frequencies(truth: str, studies: int, seed: int = 0) -> pd.DataFrame:
    """Return how often studies give each kind of verdict on a question, as shares of the studies.

    `support`: reproduced, same direction or mixed, at any look where zero is tested, at the last
    otherwise; `contradiction`: not reproduced or equivalent to zero at the last; `open`:
    inconclusive at the last. `papers` is the verdict on the paper's own numbers. Questions that
    hold by construction, or that the paper's budget does not ask, are left out.
    """
    counts: dict[str, Counter[str]] = {}
    papers: dict[str, Verdict | None] = {}
    for looks in simulated(truth, studies, seed):
        for at_looks in zip(*looks, strict=True):
            last = at_looks[-1]
            name, of = last.question.id, counts.setdefault(last.question.id, Counter())
            papers[name] = last.papers
            tested = at_looks if last.question.family else (last,)
            of["support"] += any(each.verdict in SUPPORT for each in tested)
            of["reproduced"] += last.verdict == "reproduced"
            of["contradiction"] += last.verdict in AGAINST
            of["open"] += last.verdict == "inconclusive"
            of["asked"] += last.verdict not in ("holds by construction", *UNASKED)
    rows = [
        {"question": name, "papers": papers[name]}
        | {column: of[column] / studies for column in COLUMNS}
        for name, of in counts.items()
        if of["asked"]
    ]
    return pd.DataFrame(rows)


def section(studies: int) -> str:
    """Return the generated part of the page."""
    tables = {truth: frequencies(truth, studies).set_index("question") for truth in TRUTHS}
    worlds = " | ".join(f"{truth}: for / against" for truth in TRUTHS)
    lines = [
        f"{studies} made-up studies of each world, each asked at {LOOKS[0]}, {LOOKS[1]} and "
        f"{LOOKS[2]} seeds:",
        "",
        f"| question | {worlds} | the paper's own numbers |",
        "| --- |" + " --- |" * (len(TRUTHS) + 1),
    ]
    for name, papers in tables["paper"]["papers"].items():
        each = [tables[truth].loc[str(name)] for truth in TRUTHS]
        shares = [f"{row['support']:.2f} / {row['contradiction']:.2f}" for row in each]
        said = PAPERS_WORDS.get(papers, papers) if isinstance(papers, str) else "--"
        lines.append(f"| `{name}` | {' | '.join(shares)} | {said} |")
    lines += ["", *(f"- **{truth}**: {meaning}." for truth, meaning in TRUTHS.items())]
    return "\n".join(lines) + "\n"


def write_section(studies: int, page: Path = PAGE) -> None:
    """Replace the generated part of the page."""
    text = read_bounded(page, 2**20).decode()
    write_atomically(page, replace_between(text, BEGIN, END, section(studies)).encode())


def _truth(truth: str, cell: Cell, metric: str) -> tuple[float, float]:
    """Return mean and deviation of a run of this cell."""
    outcome = "score" if metric == "score" else "final_best"
    method = cell.method if truth == "paper" else "neat"
    baseline = "neat_wo" if method == "neat_wo" else "neat"
    mean, sd = values(PRINTED_IN[outcome, baseline])[cell.task, method]
    assert sd is not None
    better = {"shift": RULES, "one better": ("bcm",)}.get(truth, ())
    shift = 1.0 if cell.method in better else 0.0
    if truth == "rates" and cell.learning_rate is not None:
        shift = 0.0 if cell.learning_rate < MIDDLE_RATE else -1.0
    return mean + shift * sd * (cell.task != "cartpole"), sd


if __name__ == "__main__":
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--studies", type=int, default=400, help="studies of each world")
    write_section(parser.parse_args().studies)
