"""The application: endings of commands, and options that commands share."""

import errno
import io
import os
import re
import sys
from collections.abc import Callable
from pathlib import Path
from typing import Annotated, Any, NoReturn, TypeVar

import typer
from typer.core import TyperCommand, TyperGroup

from neol.base.ending import BROKEN_PIPE, USER_ERROR, complain, discard_output
from neol.base.errors import INTERRUPTED, UserError
from neol.base.files import NO_ROOM
from neol.spec.readings import DEFAULT_READING

COMMANDS = {
    "Running": ("run", "status"),
    "Looking": ("show", "replay", "compare", "export", "digest", "trace", "config"),
    "Checking": ("verify", "manifest"),
}
"""Commands in the order and the sections of the help."""
EXIT_CODES = {
    0: "success",
    1: "internal error",
    2: "user error (input, disk, environment)",
    3: "check or replay mismatch",
    130: "interrupted",
    141: "broken pipe",
    143: "terminated",
}
DISAGREES = 3
EXHAUSTED = (errno.EMFILE, errno.ENFILE, errno.ENOMEM, errno.EAGAIN)
"""Errors at a limit of files, memory or processes."""
LONGEST_SUMMARY = 120
"""Largest length of a command's summary, in characters."""


Function = TypeVar("Function", bound=Callable[..., Any])


class Commands(TyperGroup):
    """Group of commands, listed by purpose, in which every error ends in one line."""

    def list_commands(self, ctx: Any) -> list[str]:
        """Return the names of the commands in the order of the help."""
        return [name for names in COMMANDS.values() for name in names]

    def format_commands(self, ctx: Any, formatter: Any) -> None:
        """Write a section for each kind of command."""
        width = max(map(len, self.list_commands(ctx)))
        for kind, names in COMMANDS.items():
            with formatter.section(kind):
                formatter.write_dl(
                    (name.ljust(width), self.commands[name].get_short_help_str(LONGEST_SUMMARY))
                    for name in names
                )

    def invoke(self, ctx: Any) -> Any:
        """Run a command. An interruption ends it with one line and its exit code."""
        try:
            result = super().invoke(ctx)
            sys.stdout.flush()
        except KeyboardInterrupt:
            complain(INTERRUPTED)
            raise typer.Exit(130) from None
        except BrokenPipeError:
            discard_output()
            raise typer.Exit(BROKEN_PIPE) from None
        return result

    def main(self, *args: Any, **extra: Any) -> NoReturn:
        """Run a command and exit."""
        extra["standalone_mode"] = False
        if isinstance(sys.stdout, io.TextIOWrapper):
            sys.stdout.reconfigure(errors="backslashreplace")  # for ± in ASCII
        os.environ.pop("MPLBACKEND", None)  # pictures go to files, which need no backend
        try:
            status = super().main(*args, **extra)
        except UserError as error:
            complain(str(error))
            status = USER_ERROR
        except (OSError, MemoryError) as error:
            complain(str(_told(error)))
            status = USER_ERROR
        except typer.TyperException as error:
            message = " ".join(error.format_message().split())
            context = getattr(error, "ctx", None)
            command = context.command_path if context else "neol"
            complain(f"{message.rstrip('.')} ({command} --help says more)")
            status = error.exit_code
        sys.exit(status or 0)


def _told(error: OSError | MemoryError) -> UserError:
    """Describe a folder that may not be entered, a full disk behind standard output, a limit."""
    if isinstance(error, MemoryError) or error.errno in EXHAUSTED:
        what = getattr(error, "strerror", None) or "Out of memory"
        return UserError(f"{what}; raise that limit (ulimit -a) or use fewer --workers")
    place = error.filename
    if place is None and error.errno in NO_ROOM:
        place = "standard output"
        discard_output()
    if place is None:
        raise error
    return UserError(f"{place}: {error.strerror}; fix that or choose another place")


class Command(TyperCommand):
    """Command that names all of its missing options and arguments at once, with an example."""

    def parse_args(self, ctx: Any, args: list[str]) -> list[str]:
        """Parse the words after a command's name."""
        given, _, _ = self.make_parser(ctx).parse_args(list(args))
        missing = [
            each.opts[0] if each.opts[0].startswith("-") else each.metavar or each.name
            for each in self.params
            if each.required and given.get(each.name) in (None, ())
        ]
        if missing and not given.get("help") and not ctx.resilient_parsing:
            example = re.sub(r" \\\n +", " ", self.epilog or "").partition("Examples:")[2].strip()
            raise UserError(
                f"{ctx.command_path} needs {', '.join(missing)}; "
                f"for example: {example.splitlines()[0]} ({ctx.command_path} --help)"
            )
        return super().parse_args(ctx, args)


class Application(typer.Typer):
    """Typer's application, with our kind of command."""

    def command(self, *args: Any, **options: Any) -> Callable[[Function], Function]:
        """Declare a command."""
        return super().command(*args, **{"cls": Command} | options)


app = Application(
    cls=Commands,
    rich_markup_mode=None,
    pretty_exceptions_enable=False,
    epilog=f"Exit codes: {', '.join(f'{code} {meaning}' for code, meaning in EXIT_CODES.items())}.",
)


def _show_version(wanted: bool) -> None:
    if wanted:
        from neol.run.provenance import package_version

        print(f"neol {package_version('neol') or '(not installed)'}", flush=True)
        raise typer.Exit


@app.callback(invoke_without_command=True)
def neol(
    context: typer.Context,
    version: Annotated[  # noqa: ARG001
        bool,
        typer.Option("--version", callback=_show_version, is_eager=True, help="Print the version."),
    ] = False,
) -> None:
    """NEOL: NEAT with reward-gated online plasticity, reproduced from seeded runs."""
    if context.invoked_subcommand is None:
        print(context.get_help())


def refuse_exhibit(path: Path) -> Path:
    """Return the path of a record. Raises UserError for a table or figure, made from records."""
    if path.suffix in (".tex", ".csv", ".pdf", ".png", ".json"):
        kind = next((each for each in ("table", "figure") if path.name.startswith(each)), "")
        what = f"a {kind}, not a record" if kind else "not a record"
        raise UserError(f"{path}: that is {what}; neol trace {path} names its records")
    return path


def refuse_exhibits(paths: list[Path]) -> list[Path]:
    """Do the same for several paths."""
    return [refuse_exhibit(path) for path in paths]


def examples(*lines: str) -> str:
    """Return an epilog whose lines are printed unchanged."""
    return "\b\nExamples:\n" + "\n".join(f"  {line}" for line in lines)


def complete_budget(incomplete: str) -> list[str]:
    """Return the budgets whose names begin with what was typed."""
    from neol.spec.configuration import budgets

    return [name for name in budgets() if name.startswith(incomplete)]


def _readings(incomplete: str) -> list[str]:
    from neol.spec.configuration import READINGS
    from neol.spec.readings import readings

    return [name for name in readings(READINGS) if name.startswith(incomplete)]


def one_reading(given: list[str] | None) -> str:
    """Return the chosen reading. Raises UserError for more than one."""
    if given and len(given) > 1:
        raise UserError(f"--reading {' --reading '.join(given)}: give one reading")
    return given[0] if given else DEFAULT_READING


RecordPath = Annotated[
    Path, typer.Argument(metavar="RECORD", help="Path of a record.", callback=refuse_exhibit)
]
BudgetOption = Annotated[
    str | None,
    typer.Option(
        help="Budget that sets constants: one of config/ such as desk, or the path of a .yaml file "
        "like those; default: paper.",
        autocompletion=complete_budget,
    ),
]
ReadingOption = Annotated[
    list[str] | None,
    typer.Option(
        help="Reading that sets constants, a file of config/readings/; "
        f"default: {DEFAULT_READING}.",
        autocompletion=_readings,
    ),
]
Overrides = Annotated[
    list[str] | None,
    typer.Option("--set", metavar="KEY=VALUE", help="Set any other constant; may be repeated."),
]


def check_output(output: Path) -> None:
    """Raise UserError before the work if its output could not be written after it."""
    if output.is_dir():
        raise UserError(f"{output}: is a folder; name a file in it")
    folder = next(each for each in output.absolute().parents if each.exists())
    if not (folder.is_dir() and os.access(folder, os.W_OK | os.X_OK)):
        raise UserError(f"{output}: {folder} is not a writable folder; choose another place")
