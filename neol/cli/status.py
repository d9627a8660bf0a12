"""`neol status`: progress of a campaign, failures, and the estimated cost of the rest."""

import time
from pathlib import Path
from typing import Annotated

import typer

from neol.base.ending import complain
from neol.base.errors import UserError
from neol.cli.application import app, examples

WATCH_SECONDS = 2.0
PIPED_WIDTH = 200
"""Width in characters without a terminal; every line fits."""


@app.command(
    epilog=examples(
        "neol status demo", "neol status results/rare_mutation/demo", "neol status demo --watch"
    )
)
def status(
    campaign: Annotated[
        Path,
        typer.Argument(
            metavar="CAMPAIGN", help="Folder like results/rare_mutation/demo, or a budget."
        ),
    ],
    watch: Annotated[
        bool, typer.Option("--watch", help="Update the display until the grid is done.")
    ] = False,
    tasks: Annotated[
        str, typer.Option("--tasks", help="Tasks to show, like cartpole,hopper; default: all.")
    ] = "",
) -> None:
    """Show a campaign's progress and the estimated cost of the rest.

    Estimates follow the task's finished runs. Before there are any, they follow docs/benchmarks.md
    and hold for the machine named there.
    """
    from rich.console import Console

    from neol.cli.progress import Display
    from neol.cli.status_view import picture, summary
    from neol.spec.readings import DEFAULT_READING
    from neol.study.campaign.grid import RESULTS
    from neol.study.campaign.shown import select
    from neol.study.workflow.outlook import Status
    from neol.study.workflow.status import Folder

    if not campaign.name:  # it is "."
        campaign = Path.cwd()
    path = RESULTS / DEFAULT_READING / campaign if len(campaign.parts) == 1 else campaign
    folder = Folder(path, select(path.name, tasks, path.absolute().parent.name))
    if not path.is_dir():
        absent = f"{path} does not exist (from {Path.cwd()})"
        if watch:
            raise UserError(f"{absent}; start its workflow, or change to its folder")
        complain(f"{absent}, so all runs are missing")
    console = Console(highlight=False)
    if not console.is_terminal:
        console.width = PIPED_WIDTH
    now = Status(folder.job_statuses())
    if watch:
        with Display(console) as display:
            while not now.over:
                display.show(summary(path, now), picture(path, now))
                time.sleep(WATCH_SECONDS)
                now = Status(folder.job_statuses())
    console.print(picture(path, now))
