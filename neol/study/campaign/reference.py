"""The paper's tables, as transcribed in paper/reference/."""

import csv
from functools import cache

from neol.spec.configuration import ROOT

REFERENCE = ROOT / "paper" / "reference"


@cache
def printed_rows(name: str, table: int) -> tuple[dict[str, str], ...]:
    """Return the rows of one of the paper's tables from a file: `configurations` or `tables`."""
    with (REFERENCE / f"{name}.csv").open(encoding="utf-8", newline="") as file:
        return tuple(row for row in csv.DictReader(file) if row["table"] == str(table))


@cache
def settings(table: int) -> dict[tuple[str, str], tuple[int, float | None]]:
    """Return population and learning rate by task and method, from Table 3 or 4."""
    return {
        (row["task"], row["method"]): (int(row["population"]), optional(row["learning_rate"]))
        for row in printed_rows("configurations", table)
    }


def optional(number: str) -> float | None:
    """Return a number of a table; None for an empty field."""
    return float(number) if number else None
