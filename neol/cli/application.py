"""The application: how its commands fail, what their options share."""

import sys
from typing import Annotated, Any, NoReturn

import typer
from typer.core import TyperGroup

from neol.errors import UserError

DEFAULT_BUDGET = "paper"
"""Its constants are those of config/base.yaml."""


class Commands(TyperGroup):
    """Ends in one line and exit code 2 for whatever is wrong with the input."""

    def main(self, *args: Any, **extra: Any) -> NoReturn:
        """Run a command and exit."""
        extra["standalone_mode"] = False
        try:
            status = super().main(*args, **extra)
        except UserError as error:
            complain(str(error))
            status = 2
        except typer.TyperException as error:
            complain(f"{error.format_message()} (neol COMMAND --help says more)")
            status = error.exit_code
        sys.exit(status or 0)


app = typer.Typer(
    cls=Commands,
    add_completion=False,
    rich_markup_mode=None,
    pretty_exceptions_enable=False,
    epilog="Exit codes: 0 done, 1 a bug of ours, 2 wrong input, 3 neol verify found something "
    "wrong, 130 interrupted, 143 terminated.",
)


def _show_version(wanted: bool) -> None:
    if wanted:
        from neol.provenance import package_version

        print(f"neol {package_version('neol') or '(not installed)'}")
        raise typer.Exit


@app.callback(invoke_without_command=True)
def neol(
    context: typer.Context,
    version: Annotated[  # noqa: ARG001
        bool, typer.Option("--version", callback=_show_version, is_eager=True, help="Its number.")
    ] = False,
) -> None:
    """NEOL: NEAT with reward-gated online plasticity, reproduced from seeded runs."""
    if context.invoked_subcommand is None:
        print(context.get_help())


def examples(*lines: str) -> str:
    """An epilog whose lines stay as they are."""
    return "\b\nExamples:\n" + "\n".join(f"  {line}" for line in lines)


Budget = Annotated[
    str | None,
    typer.Option(help="Whose constants hold: a file of config/, like desk."),
]
Overrides = Annotated[
    list[str] | None,
    typer.Option("--set", metavar="KEY=VALUE", help="Any other constant; may be repeated."),
]


def complain(line: str) -> None:
    """Say on the console what is wrong, in one line."""
    print(f"neol: {line}", file=sys.stderr)
