"""What is there, and where it comes from: digests, traces, configurations, benchmarks."""

from pathlib import Path
from typing import Annotated

import typer

from neol.cli.application import Budget, Overrides, app, examples
from neol.errors import UserError


@app.command(epilog=examples("neol digest a.parquet"))
def digest(record: Annotated[Path, typer.Argument(metavar="RECORD", help="A record.")]) -> None:
    """Print each seed of a record and the digest of its trajectory."""
    from neol.records import read_record

    for info in read_record(record).seeds:
        print(info.seed, info.digest)


@app.command(epilog=examples("neol trace figures/table1.tex"))
def trace(
    output: Annotated[Path, typer.Argument(metavar="OUTPUT", help="A table or figure.")],
) -> None:
    """Print what made a table or figure: command, commit, records, runs."""
    from neol.trace import trace

    for line in trace(output):
        print(line)


@app.command(
    epilog=examples(
        "neol config --budget desk", "neol config --set neat.elitism=3", "neol config --schema"
    )
)
def config(
    budget: Budget = None,
    overrides: Overrides = None,
    schema: Annotated[
        bool, typer.Option("--schema", help="Print the JSON schema of a configuration file.")
    ] = False,
) -> None:
    """Print a budget's resolved configuration as YAML."""
    import json

    import yaml

    from neol import spec

    if schema:
        print(json.dumps(spec.schema(), indent=2))
        return
    configuration = spec.load_configuration(budget or spec.DEFAULT_BUDGET, overrides or [])
    content = configuration.model_dump(
        mode="json", exclude={"tasks": {"__all__": {"name"}}, "budget": {"name"}}
    )
    print(yaml.safe_dump(content, sort_keys=False), end="")


@app.command(
    add_help_option=False,  # its options are those of benchmarks.run, which has a help of its own
    context_settings={"allow_extra_args": True, "ignore_unknown_options": True},
)
def bench(context: typer.Context) -> None:
    """Measure every engine beside physics and a peer, in a checkout."""
    try:
        from benchmarks.run import main
    except ModuleNotFoundError as error:
        raise UserError(f"no module {error.name}: benchmarks run in a checkout") from None
    main(context.args)
