"""The paper's own numbers, as transcribed in paper/reference/."""

import csv
from collections.abc import Iterator

from neol.campaign import REFERENCE


def values(table: int) -> dict[tuple[str, str], tuple[float, float | None]]:
    """Value and deviation by task and column of Tables 1, 2, 5-8; p-values have no deviation."""
    return {
        (row["task"], row["column"]): (float(row["value"]), _optional(row["sd"]))
        for row in _rows("tables", table)
    }


def settings(table: int) -> dict[tuple[str, str], tuple[int, float | None]]:
    """Population and learning rate by task and method, of Table 3 or 4."""
    return {
        (row["task"], row["method"]): (int(row["population"]), _optional(row["learning_rate"]))
        for row in _rows("configurations", table)
    }


def _rows(name: str, table: int) -> Iterator[dict[str, str]]:
    with (REFERENCE / f"{name}.csv").open(encoding="utf-8", newline="") as file:
        yield from (row for row in csv.DictReader(file) if row["table"] == str(table))


def _optional(number: str) -> float | None:
    return float(number) if number else None
