"""The multiverse in docs/readings.md: sentences, a table, pictures and numbers."""

from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Any

from neol.base.files import write_atomically
from neol.pictures.labels import method_label, task_label
from neol.pictures.style import write_picture
from neol.study.campaign.grid import RESULTS
from neol.study.campaign.multiverse import universes
from neol.study.outcomes.multiverse import METRICS, Answers, answers, summary
from neol.study.output.captions import by_task
from neol.study.report.multiverse_picture import specification_curve

HEAD = ["question", "median", "least to greatest", "above", "clearly above", "clearly below"]


KINDS: list[tuple[str, Callable[[Any], bool]]] = [
    ("distinguishably above under every reading", lambda row: row.clearly_above == 1),
    (
        "above under some readings and below under none",
        lambda row: 0 < row.clearly_above < 1 and not row.clearly_below,
    ),
    (
        "above under some readings and below under others",
        lambda row: row.clearly_above > 0 and row.clearly_below > 0,
    ),
    (
        "below under some readings and above under none",
        lambda row: row.clearly_below > 0 and not row.clearly_above,
    ),
    (
        "distinguishable under no reading",
        lambda row: not row.clearly_above and not row.clearly_below,
    ),
]
"""What may hold of a question's answers; "above" and "below" are meant distinguishably."""


class Multiverse:
    """The multiverse's answers in words."""

    def __init__(self, results: Path = RESULTS) -> None:
        self.answers: Answers = answers(results)
        self.tasks = [task for task, count in self.answers.readings.items() if count]
        """Tasks that have answers."""
        self.whole = len(universes())
        """Number of readings in the grid."""

    def extent(self) -> str:
        """Say under how many readings the questions have answers: 12 of 32 (CartPole)."""
        there = self.answers.readings
        return by_task({task: f"{there[task]} of {self.whole}" for task in self.tasks})

    def findings(self) -> list[tuple[str, int, list[str]]]:
        """Group the questions by what holds of their answers under all readings.

        Each group has its name, its number of questions, and its comparisons with their rules.
        """
        rows = list(summary(self.answers.table).itertuples())
        groups = [(name, [row for row in rows if holds(row)]) for name, holds in KINDS]
        return [(name, len(group), _compared(group)) for name, group in groups]

    def headline(self) -> str:
        """Count the questions of each group in two sentences."""
        groups = self.findings()
        questions = sum(count for _, count, _ in groups)
        return (
            f"In short runs, {questions} questions (is a rule above NEAT, or above NEAT without "
            f"weight mutation?) were asked under {self.extent()} readings. How often the rule "
            f"is {'; '.join(f'{name}: {count}' for name, count, _ in groups)}."
        )

    def numbers(self, task: str) -> list[list[str]]:
        """Return a head, and a row for each question of a task."""
        table = self.answers.table
        return [HEAD, *map(_row, summary(table[table["task"] == task]).itertuples())]

    def write(self, folder: Path) -> None:
        """Write the answers as a CSV, and a task's specification curves as a picture each."""
        text = self.answers.table.to_csv(index=False, float_format="%.6g", lineterminator="\n")
        write_atomically(folder / "readings-multiverse.csv", text.encode())
        for task in self.tasks:
            picture = specification_curve(self.answers.table, task)
            write_picture(picture, folder / picture_name(task))


def picture_name(task: str) -> str:
    """Return the file name of a task's specification curves."""
    return f"readings-multiverse-{task}.png"


def _compared(rows: Sequence[Any]) -> list[str]:
    """Name comparisons once with their rules: SCORE against NEAT on CartPole (BCM, Hebb)."""
    rules: dict[str, list[str]] = {}
    for row in rows:
        against = f"{METRICS[row.metric]} against {method_label(row.against)}"
        rules.setdefault(f"{against} on {task_label(row.task)}", []).append(
            method_label(row.method)
        )
    return [f"{name} ({', '.join(each)})" for name, each in rules.items()]


def _comparison(row: Any) -> str:
    against = method_label(row.against)
    return f"{method_label(row.method)} against {against} in {METRICS[row.metric]}"


def _row(row: Any) -> list[str]:
    digits = 3 if row.metric == "score" else 0
    least, median, greatest = (
        f"{round(value, digits) + 0.0:.{digits}f}"
        for value in (row.least, row.median, row.greatest)
    )
    shares = (f"{share:.0%}" for share in (row.above, row.clearly_above, row.clearly_below))
    return [_comparison(row), median, f"{least} to {greatest}", *shares]
