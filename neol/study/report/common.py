"""Shared parts of this folder's programs: arguments, verified files of the workflow, templates."""

import argparse
import hashlib
import io
from collections.abc import Callable
from pathlib import Path

import jinja2
import pandas as pd

from neol.base.ending import exit_codes
from neol.base.errors import UserError
from neol.base.files import read_bounded
from neol.spec.readings import DEFAULT_READING
from neol.study.campaign.grid import RESULTS
from neol.study.campaign.shown import select
from neol.study.outcomes.campaign_runs import Campaign
from neol.study.output.sidecar import Sidecar
from neol.study.tables import agreement, paper_tables
from neol.study.tables.table import Table

MAX_BYTES = 2**27


def command_line(module: str, purpose: str | None, work: Callable[..., None], **paths: str) -> None:
    """Run `work` as a program, with a budget's campaign and paths from the command line.

    `paths` gives the meaning of each path.
    """
    parser = argparse.ArgumentParser(prog=f"python -m {module}", description=purpose)
    parser.add_argument("budget")
    parser.add_argument(
        "--reading", default=DEFAULT_READING, help="the reading of the budget's runs"
    )
    parser.add_argument(
        "--tasks", default="", help="only these tasks of the budget: cartpole,hopper"
    )
    for name, meaning in paths.items():
        parser.add_argument(name, type=Path, help=meaning)
    arguments = vars(parser.parse_args())
    with exit_codes():
        chosen = (arguments.pop(name) for name in ("budget", "tasks", "reading"))
        configuration = select(*chosen)
        work(Campaign(configuration, RESULTS), **arguments)


def read(path: Path) -> bytes:
    """Read a file that the workflow makes. Raises UserError if it is missing."""
    try:
        return read_bounded(path, MAX_BYTES)
    except UserError as error:
        raise UserError(f"{error}; `make report` makes what is missing") from None


def verified(output: Path) -> tuple[bytes, Sidecar]:
    """Read a table or figure, and the sidecar that says what made it.

    Raises UserError if one is missing, or if the file, or one that was made with it (a table's
    LaTeX, a figure's PDF), differs from the one that the sidecar describes.
    """
    content = read(output)
    sidecar = Sidecar.read(output.with_suffix(".json"))
    for name in {output.name, *sidecar.outputs}:
        file = output.with_name(name)
        if hashlib.sha256(read(file)).hexdigest() != sidecar.outputs.get(name):
            raise UserError(
                f"{file}: changed since {output.stem}.json was written; "
                "remove both, and `make report` makes them again"
            )
    return content, sidecar


def verified_frame(path: Path) -> pd.DataFrame:
    """Read a table's cells from its CSV. Raises UserError as `verified` does."""
    content, _ = verified(path)
    return pd.read_csv(io.BytesIO(content))


def verified_table(campaign: Campaign, figures: Path, name: str) -> tuple[Table, Sidecar]:
    """Make a table again, and check that its file holds the same.

    Raises UserError if it does not, or as `verified` does.
    """
    makers = agreement if name.startswith("numbers") else paper_tables
    table: Table = getattr(makers, name)(campaign)
    file = figures / f"{name}.csv"
    content, sidecar = verified(file)
    if content != table.csv():
        raise UserError(f"{file}: not what the records say now; `{sidecar.command}` makes it again")
    return table, sidecar


def render(template: str, **values: object) -> str:
    """Fill in one of the templates of this folder; values are escaped in HTML.

    Raises jinja2.UndefinedError for a name without a value.
    """
    environment = jinja2.Environment(
        loader=jinja2.PackageLoader("neol.study.report", "."),
        autoescape=jinja2.select_autoescape(["html.j2"]),
        undefined=jinja2.StrictUndefined,
        trim_blocks=True,
        lstrip_blocks=True,
        keep_trailing_newline=True,
    )
    environment.filters["short"] = lambda digest: digest[:12]
    return environment.get_template(template).render(values)
