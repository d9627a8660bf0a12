"""A table as LaTeX, Markdown, HTML and CSV, and the list of records that it was made from."""

import html
from dataclasses import dataclass
from pathlib import Path
from typing import Literal, NamedTuple

import pandas as pd

from neol.base.files import write_atomically
from neol.spec.configuration import Configuration
from neol.study.outcomes.campaign_runs import Source
from neol.study.output import markdown
from neol.study.output.latex import escape
from neol.study.output.sidecar import command, write_sidecar

Emphasis = Literal["best", "runner-up", ""]


class Entry(NamedTuple):
    """A printed value; "best" is bold, "runner-up" underlined."""

    text: str
    emphasis: Emphasis = ""


class Line(NamedTuple):
    """A line of a table: its label, and an entry for each column."""

    label: str
    entries: tuple[Entry, ...]
    is_beneath: bool
    """Whether the line is printed small, beneath its main line, as the paper's values are."""


@dataclass(frozen=True, repr=False)
class Table:
    """A table of the paper, made from a campaign's records. A notebook shows it as HTML."""

    name: str
    """The stem of its files: table1."""
    number: str
    """Number in print: 1, as in the paper; 1a for a table that the paper does not have."""
    caption: str
    columns: tuple[str, ...]
    lines: tuple[Line, ...]
    notes: tuple[str, ...]
    """Notes on incomplete values, each after its mark, and on contradictions of the paper."""
    frame: pd.DataFrame
    """A row for each task and method, at full precision; `paper_` marks the paper's columns."""
    configuration: Configuration
    sources: tuple[Source, ...]
    """The records behind it."""

    def write(self, folder: Path) -> None:
        """Write name.tex, .md (to read), .csv (full precision) and .json (where it comes from)."""
        folder.mkdir(parents=True, exist_ok=True)
        path, page, csv = (folder / f"{self.name}.{kind}" for kind in ("tex", "md", "csv"))
        made_by = (
            f"% Made by `{command(path, self.configuration)}` from what {self.name}.json lists."
        )
        write_atomically(path, f"{made_by}\n{self.latex()}\n".encode())
        title = f"# Table {self.number}\n\n{self.caption}\n\n"
        notes = "".join(f"\n{note}\n" for note in self.notes)
        write_atomically(page, f"{title}{self.markdown()}{notes}".encode())
        write_atomically(csv, self.csv())
        write_sidecar([path, csv, page], self.configuration, self.sources)

    def csv(self) -> bytes:
        """Return `frame` as its CSV file holds it."""
        return self.frame.to_csv(index=False).encode()

    def latex(self) -> str:
        """Return LaTeX for \\input, numbered as in the paper; it needs the package booktabs."""
        return "\n".join(
            [
                "\\begin{table}[tbp]",
                f"  \\renewcommand{{\\thetable}}{{{self.number}}}",
                "  \\centering",
                f"  \\caption{{{escape(self.caption)}}}",
                f"  \\label{{tab:{self.name}}}",
                "  \\medskip",
                f"  \\begin{{tabular}}{{l{'c' * len(self.columns)}}}",
                "    \\toprule",
                "    " + " & ".join(["Task", *map(escape, self.columns)]) + " \\\\",
                "    \\midrule",
                *(
                    f"    {_latex_line(line)}{self._gap_below(i)}"
                    for i, line in enumerate(self.lines)
                ),
                "    \\bottomrule",
                "  \\end{tabular}",
                *(f"  \\par\\footnotesize {escape(note)}" for note in self.notes),
                "\\end{table}",
            ]
        )

    def _gap_below(self, i: int) -> str:
        """Return LaTeX's gap between a task's last line and the next task."""
        after = self.lines[i + 1 : i + 2]
        is_last = self.lines[i].is_beneath and not any(line.is_beneath for line in after)
        return " \\addlinespace" if is_last else ""

    def markdown(self) -> str:
        """Return the table in Markdown: bold is best, italic the runner-up."""
        marks = {"best": "**%s**", "runner-up": "*%s*", "": "%s"}
        rows = [
            [line.label, *(marks[emphasis] % text for text, emphasis in line.entries)]
            for line in self.lines
        ]
        return f"{markdown.table(['Task', *self.columns], rows)}\n"

    def html_table(self) -> str:
        """Return the table in HTML, with its notes and without its caption."""
        head = "".join(
            f'<th scope="col">{html.escape(text)}</th>' for text in ("Task", *self.columns)
        )
        body = "".join(map(_html_line, self.lines))
        notes = "".join(f"<p>{html.escape(note)}</p>" for note in self.notes)
        return f"<table><thead><tr>{head}</tr></thead><tbody>{body}</tbody></table>{notes}"

    def _repr_html_(self) -> str:
        return f"<p>{html.escape(self.caption)}</p>{self.html_table()}"


def _html_line(line: Line) -> str:
    tags = {"best": "<b>%s</b>", "runner-up": "<u>%s</u>", "": "%s"}
    cells = "".join(
        f"<td>{tags[emphasis] % html.escape(text)}</td>" for text, emphasis in line.entries
    )
    row = '<tr class="beneath">' if line.is_beneath else "<tr>"
    return f'{row}<th scope="row">{html.escape(line.label)}</th>{cells}</tr>'


def latex_entry(entry: Entry) -> str:
    """Return a value in LaTeX with its emphasis."""
    commands = {"best": "\\textbf{%s}", "runner-up": "\\underline{%s}", "": "%s"}
    return commands[entry.emphasis] % escape(entry.text)


def _latex_line(line: Line) -> str:
    label = f"\\quad {escape(line.label)}" if line.is_beneath else escape(line.label)
    cells = [label, *map(latex_entry, line.entries)]
    size = "\\footnotesize " if line.is_beneath else ""
    return " & ".join(f"{size}{cell}" for cell in cells) + " \\\\"
