"""`neol status`: how far a campaign is, what failed, what the rest will cost."""

import time
from pathlib import Path
from typing import Annotated

import typer

from neol.base.ending import complain
from neol.base.errors import UserError
from neol.cli.application import app, examples

WATCH_SECONDS = 2.0
PIPED_WIDTH = 200
"""Characters; wide enough for every line."""


@app.command(
    epilog=examples(
        "neol status demo", "neol status results/first/demo", "neol status demo --watch"
    )
)
def status(
    campaign: Annotated[
        Path,
        typer.Argument(metavar="CAMPAIGN", help="A folder like results/first/desk, or a budget."),
    ],
    watch: Annotated[
        bool, typer.Option("--watch", help="Go on showing it until the grid is done.")
    ] = False,
    tasks: Annotated[
        str, typer.Option("--tasks", help="Some of its tasks only, like cartpole,hopper.")
    ] = "",
) -> None:
    """Show what of a campaign is done, running, failed or missing, and what the rest will cost.

    Costs are those measured in docs/benchmarks.md, on the machine named there.
    """
    from rich.console import Console

    from neol.cli.progress import Display
    from neol.cli.status_view import picture, summary
    from neol.study.campaign.grid import RESULTS
    from neol.study.campaign.shown import SHOWN_READING, select
    from neol.study.workflow.outlook import Status
    from neol.study.workflow.status import Folder

    if not campaign.name:  # it is "."
        campaign = Path.cwd()
    path = RESULTS / SHOWN_READING / campaign if len(campaign.parts) == 1 else campaign
    folder = Folder(path, select(path.name, tasks, path.absolute().parent.name))
    if not path.is_dir():
        nowhere = f"{path} does not exist (from {Path.cwd()})"
        if watch:
            raise UserError(f"{nowhere}; start its workflow, or go where that runs")
        complain(f"{nowhere}, so all is missing")
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
