"""Commands of the study: compare records, trace a table or figure."""

from pathlib import Path
from typing import Annotated

import typer

from neol.cli.application import app, check_output, examples, refuse_exhibits

PIPED_WIDTH = 10_000
"""Width in characters without a terminal, so that no line is broken."""


@app.command(epilog=examples("neol trace figures/table1.tex"))
def trace(
    output: Annotated[Path, typer.Argument(metavar="OUTPUT", help="File of a table or figure.")],
) -> None:
    """Print the command, commit, records and runs behind an output."""
    from neol.base.errors import printable
    from neol.study.output.sidecar import trace

    for line in trace(output):
        print(printable(line))


@app.command(
    epilog=examples(
        "neol compare a.parquet b.parquet",
        "neol compare results/rare_mutation/demo/cartpole/bcm/p050_lr0.25 \\",
        "    results/rare_mutation/demo/cartpole/neat/p050 --output curves.png",
    )
)
def compare(
    records: Annotated[
        list[Path],
        typer.Argument(
            metavar="RECORD",
            help="Records, or folders of one cell's records.",
            callback=refuse_exhibits,
        ),
    ],
    output: Annotated[
        Path | None, typer.Option(help="Draw learning curves into a .png, .pdf or .svg.")
    ] = None,
) -> None:
    """Print the configurations and results of records side by side."""
    from rich.console import Console
    from rich.table import Table
    from rich.text import Text

    from neol.base.errors import printable
    from neol.pictures.style import picture_kind, write_picture
    from neol.study.figures.side_by_side import (
        differing_constants,
        learning_curves,
        outcome_rows,
        read_compared,
    )

    if output:
        picture_kind(output)
        check_output(output)
    compared = read_compared(records)
    table = Table("", *(each.letter for each in compared), box=None, pad_edge=False)
    for name, values in (differing_constants(compared) | outcome_rows(compared)).items():
        table.add_row(*(Text(printable(cell)) for cell in (name, *values)))  # no markup
    for each in compared:
        print(printable(f"{each.letter}  {each.path}"))
    console = Console(highlight=False)
    if not console.is_terminal:
        console.width = PIPED_WIDTH
    console.print(table)
    print("Means over runs, with 95% intervals if there are several runs.")
    if output:
        write_picture(learning_curves(compared), output)
        print(f"{output}: learning curves")
