"""Look at a record's digests and at a budget's configuration."""

from pathlib import Path
from typing import Annotated

import typer

from neol.cli.application import (
    BudgetOption,
    Overrides,
    ReadingOption,
    app,
    examples,
    one_reading,
)


@app.command(epilog=examples("neol digest a.parquet"))
def digest(record: Annotated[Path, typer.Argument(metavar="RECORD", help="A record.")]) -> None:
    """Print each seed of a record and the digest of its trajectory."""
    from neol.run.record_file import read_record

    for info in read_record(record).seeds:
        print(info.seed, info.digest)


@app.command(
    epilog=examples(
        "neol config --budget desk",
        "neol config --reading first --set neat.elitism=3",
        "neol config --schema",
    )
)
def config(
    budget: BudgetOption = None,
    reading: ReadingOption = None,
    overrides: Overrides = None,
    schema: Annotated[
        bool, typer.Option("--schema", help="Print the JSON schema of a configuration file.")
    ] = False,
) -> None:
    """Print a budget's resolved configuration under a reading, as YAML."""
    import json
    import sys

    from ruamel.yaml import YAML

    from neol.spec import configuration as spec

    if schema:
        print(json.dumps(spec.schema(), indent=2))
        return
    configuration = spec.load_configuration(
        budget or spec.PAPER_BUDGET, overrides or [], reading=one_reading(reading)
    )
    content = configuration.model_dump(
        mode="json",
        exclude={"reading": True, "tasks": {"__all__": {"name"}}, "budget": {"name"}},
    )
    print(f"# Budget {configuration.budget.name}, reading {configuration.reading}")
    YAML().dump(content, sys.stdout)
