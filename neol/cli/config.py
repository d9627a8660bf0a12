"""`neol config`: the resolved configuration of a budget, or the schema of its files."""

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

    from neol.spec.configuration import PAPER_BUDGET, configuration_schema, load_configuration

    if schema:
        print(json.dumps(configuration_schema(), indent=2))
        return
    configuration = load_configuration(
        budget or PAPER_BUDGET, overrides or [], reading=one_reading(reading)
    )
    content = configuration.model_dump(
        mode="json",
        exclude={"reading": True, "tasks": {"__all__": {"name"}}, "budget": {"name"}},
    )
    print(f"# Budget {configuration.budget.name}, reading {configuration.reading}")
    YAML().dump(content, sys.stdout)
