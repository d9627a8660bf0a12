"""The paper's Tables 1 and 3 from a budget's records, each value beside the paper's own."""

import html
import math
import re
from collections.abc import Callable, Sequence
from dataclasses import asdict, dataclass
from pathlib import Path
from string import ascii_lowercase
from typing import NamedTuple

import pandas as pd

from neol.analysis.choice import METHODS, candidates
from neol.analysis.runs import Campaign, Source
from neol.analysis.sidecar import command, write_sidecar
from neol.analysis.summary import Comparison, OwnSummary, Rank, Summary, best_fitness
from neol.files import write_atomically
from neol.spec import Configuration, load_configuration

TASK_LABELS = {
    "cartpole": "CartPole",
    "lunar_lander": "Lunar Lander",
    "hopper": "Hopper",
    "bipedal_walker": "Bipedal Walker",
}
METHOD_LABELS = {"bcm": "BCM", "hebb": "Hebb", "oja": "Oja", "neat": "NEAT"}
NOTHING = "--"
_MEANS: dict[str, Callable[[Comparison], float]] = {
    "here": lambda comparison: comparison.here.mean,
    "paper": lambda comparison: comparison.paper.mean,
}

# --- Tables -------------------------------------------------------------------------------------


class Entry(NamedTuple):
    """A printed value and how it stands in its line."""

    text: str
    rank: Rank = ""


class Line(NamedTuple):
    """A line of a table: its label, and an entry for each column."""

    label: str
    entries: tuple[Entry, ...]
    is_paper: bool
    """The paper's own values, printed small beneath ours."""


@dataclass(frozen=True, repr=False)
class Table:
    """A table of the paper, made from a campaign's records. A notebook shows it as HTML."""

    number: int
    """In the paper."""
    caption: str
    columns: tuple[str, ...]
    lines: tuple[Line, ...]
    notes: tuple[str, ...]
    """What is incomplete, each beginning with its mark in the table."""
    comparisons: tuple[Comparison, ...]
    """A row of the CSV each."""
    configuration: Configuration
    sources: tuple[Source, ...]
    """The records behind it."""

    @property
    def name(self) -> str:
        """The stem of its files: table1."""
        return f"table{self.number}"

    @property
    def frame(self) -> pd.DataFrame:
        """A row for each task and method, at full precision; the paper's have `paper_` in front."""
        frame = pd.DataFrame([_flat(each) for each in self.comparisons])
        return frame.astype({"population": "Int64", "paper_population": "Int64"})

    def write(self, folder: Path) -> None:
        """Write name.tex, name.csv (full precision) and name.json (where it comes from)."""
        folder.mkdir(parents=True, exist_ok=True)
        path = folder / f"{self.name}.tex"
        made_by = (
            f"% Made by `{command(path, self.configuration)}` from what {self.name}.json lists."
        )
        write_atomically(path, f"{made_by}\n{self.latex()}\n".encode())
        write_atomically(path.with_suffix(".csv"), self.frame.to_csv(index=False).encode())
        write_sidecar(path, self.configuration, self.sources)

    def latex(self) -> str:
        """A table for \\input, numbered as in the paper; it needs the package booktabs."""
        return "\n".join(
            [
                "\\begin{table}[tbp]",
                f"  \\renewcommand{{\\thetable}}{{{self.number}}}",
                "  \\centering",
                f"  \\caption{{{_latex(self.caption)}}}",
                f"  \\label{{tab:{self.name}}}",
                "  \\medskip",
                f"  \\begin{{tabular}}{{l{'c' * len(self.columns)}}}",
                "    \\toprule",
                "    " + " & ".join(["Task", *map(_latex, self.columns)]) + " \\\\",
                "    \\midrule",
                *(f"    {_latex_line(line)}" for line in self.lines),
                "    \\bottomrule",
                "  \\end{tabular}",
                *(f"  \\par\\footnotesize {_latex(note)}" for note in self.notes),
                "\\end{table}",
            ]
        )

    def _repr_html_(self) -> str:
        tags = {"best": "b", "runner-up": "u", "": "span"}
        head = "".join(f"<th>{html.escape(text)}</th>" for text in ("Task", *self.columns))
        body = ""
        for line in self.lines:
            cells = "".join(
                f"<td><{tags[rank]}>{html.escape(text)}</{tags[rank]}></td>"
                for text, rank in line.entries
            )
            body += f"<tr><td>{html.escape(line.label)}</td>{cells}</tr>"
        notes = "".join(f"<p>{html.escape(note)}</p>" for note in self.notes)
        caption = f"<caption>{html.escape(self.caption)}</caption>"
        return f"<table>{caption}<tr>{head}</tr>{body}</table>{notes}"


def table1(campaign: Campaign) -> Table:
    """Table 1: best final-generation fitness, mean and standard deviation over seeds."""
    title = (
        "Best final-generation fitness, mean ± SD over seeds (n - 1 in its denominator); beneath "
        "each value the paper's own. Bold marks a row's highest mean, underline the runner-up; "
        "equal means are marked alike, and a shared first place leaves no runner-up. The "
        "configurations are those of Table 3."
    )
    return _table(1, title, _value, campaign)


def table3(campaign: Campaign) -> Table:
    """Table 3: the configurations that Table 1 shows."""
    title = (
        "Configurations behind Table 1, beneath each the paper's own. Where the budget's grid has "
        "the paper's, it is taken; otherwise the cell of the grid with the highest mean of the "
        "best final-generation fitness over seeds (of equal means the smaller population, then "
        "the smaller rate)."
    )
    return _table(3, title, _setting, campaign)


def lead_over_neat(comparisons: Sequence[Comparison]) -> pd.DataFrame:
    """How far each rule's mean is above NEAT's, here and in the paper: a row for each task."""
    rows = {}
    for task in dict.fromkeys(each.task for each in comparisons):
        row = {each.method: each for each in comparisons if each.task == task}
        rows[task_label(task)] = {
            (METHOD_LABELS[method], place): mean(row[method]) - mean(row["neat"])
            for method in METHODS[:-1]
            for place, mean in _MEANS.items()
        }
    return pd.DataFrame.from_dict(rows, orient="index").round(2)


def describe_budget(configuration: Configuration) -> str:
    """A budget in a sentence or two, for captions."""
    budget, episodes = configuration.budget, configuration.evaluation.episodes
    steps = ", ".join(
        f"{configuration.tasks[task].max_steps} ({task_label(task)})" for task in budget.tasks
    )
    sentence = (
        f"Budget {budget.name}: G = {budget.generations} generations, {budget.seeds} seeds, "
        f"N = {episodes} episode{'s' * (episodes > 1)} per evaluation of at most {steps} steps."
    )
    is_paper = configuration == load_configuration("paper")
    return sentence if is_paper else f"{sentence} Reduced budget: not the paper's."


def task_label(task: str) -> str:
    """A task's name as the paper prints it."""
    return TASK_LABELS.get(task, task.replace("_", " ").title())


def _table(number: int, title: str, entry: Callable[[Summary], Entry], campaign: Campaign) -> Table:
    """A table whose entries are printed by `entry`."""
    configuration = campaign.configuration
    comparisons = best_fitness(campaign)
    reasons = dict.fromkeys(each.here.incomplete for each in comparisons if each.here.incomplete)
    marks = {
        reason: f"({letter})" for reason, letter in zip(reasons, ascii_lowercase, strict=False)
    }

    def marked(own: OwnSummary) -> Entry:
        text, rank = entry(own)
        return Entry(f"{text} {marks.get(own.incomplete, '')}".strip(), rank)

    lines = []
    for task in configuration.budget.tasks:
        row = [each for each in comparisons if each.task == task]
        lines += [
            Line(task_label(task), tuple(marked(each.here) for each in row), is_paper=False),
            Line("paper", tuple(entry(each.paper) for each in row), is_paper=True),
        ]
    return Table(
        number=number,
        caption=f"{title} {describe_budget(configuration)}",
        columns=tuple(METHOD_LABELS[method] for method in METHODS),
        lines=tuple(lines),
        notes=tuple(f"{mark} {reason}." for reason, mark in marks.items()),
        comparisons=tuple(comparisons),
        configuration=configuration,
        sources=tuple(
            source
            for cells in candidates(configuration).values()
            for cell in cells
            for source in campaign.runs(cell).sources
        ),
    )


def _flat(comparison: Comparison) -> dict[str, object]:
    return {
        "task": comparison.task,
        "method": comparison.method,
        **asdict(comparison.here),
        **{f"paper_{name}": value for name, value in asdict(comparison.paper).items()},
    }


# --- Printing -----------------------------------------------------------------------------------


def _value(summary: Summary) -> Entry:
    """324.34 ± 3.86, as Table 1 prints it."""
    if math.isnan(summary.mean):
        return Entry(NOTHING)
    sd = NOTHING if math.isnan(summary.sd) else f"{summary.sd:.2f}"
    return Entry(f"{summary.mean:.2f} ± {sd}", summary.rank)


def _setting(summary: Summary) -> Entry:
    """pop=300, lr=0.25, as Table 3 prints it."""
    if summary.population is None:
        return Entry(NOTHING)
    rate = "" if summary.learning_rate is None else f", lr={summary.learning_rate:g}"
    return Entry(f"pop={summary.population}{rate}")


def _latex_line(line: Line) -> str:
    commands = {"best": "\\textbf{%s}", "runner-up": "\\underline{%s}", "": "%s"}
    label = f"\\quad {line.label}" if line.is_paper else _latex(line.label)
    cells = [label, *(commands[rank] % _latex(text) for text, rank in line.entries)]
    size, gap = ("\\footnotesize ", " \\addlinespace") if line.is_paper else ("", "")
    return " & ".join(f"{size}{cell}" for cell in cells) + " \\\\" + gap


def _latex(text: str) -> str:
    escaped = re.sub(r"([&%#_])", r"\\\1", text).replace("±", "$\\pm$")
    return re.sub(r"(?<![\w-])-(?=\d)|(?<= )-(?= )", "$-$", escaped)  # minus signs, but no dashes
