"""The rows of a record: a column for each of its values, a row for each generation of each seed.

`python -m neol.columns` prints the table of columns that stands in docs/records.md.
"""

from collections.abc import Sequence
from typing import Any, get_type_hints

import numpy as np
import numpy.typing as npt
import pyarrow as pa

from neol.evolution import COLUMNS, Generation

_VALUES = get_type_hints(Generation, include_extras=True)
DOCUMENTATION: dict[str, tuple[str, str]] = {
    "seed": ("", "The run's seed."),
    **{name: value.__metadata__ for name, value in _VALUES.items()},
}
"""Each column's unit and meaning."""
_INTEGERS = {"seed"} | {name for name, value in _VALUES.items() if value.__origin__ is int}
SCHEMA = pa.schema(
    [
        pa.field(
            name,
            pa.int64() if name in _INTEGERS else pa.float64(),
            nullable=False,
            metadata={"unit": unit, "meaning": meaning},
        )
        for name, (unit, meaning) in DOCUMENTATION.items()
    ]
)


def describe_columns() -> str:
    """The columns as a Markdown table."""

    def cell(text: str) -> str:
        return text.replace("|", "\\|") or "-"

    rows = [
        f"| `{field.name}` | {field.type} | {cell(unit)} | {cell(meaning)} |"
        for field, (unit, meaning) in zip(SCHEMA, DOCUMENTATION.values(), strict=True)
    ]
    return "\n".join(["| column | type | unit | meaning |", "| --- | --- | --- | --- |", *rows])


def history_table(seed: int, history: Sequence[Generation]) -> pa.Table:
    """A run's rows."""
    columns = {name: [getattr(row, name) for row in history] for name in COLUMNS}
    columns["seed"] = [seed] * len(history)
    return pa.Table.from_arrays(
        [_array(columns[field.name], field.type) for field in SCHEMA], schema=SCHEMA
    )


# pyarrow imports all of pandas in pa.array and to_numpy, which takes longer than a short run.


def _array(values: list[float], kind: pa.DataType) -> pa.Array:
    content = np.array(values, dtype=kind.to_pandas_dtype())
    return pa.Array.from_buffers(kind, len(values), [None, pa.py_buffer(content)])


def column_values(table: pa.Table, column: str) -> npt.NDArray[Any]:
    """One of the columns, int64[rows] or float64[rows]."""
    array = table[column].combine_chunks()
    kind = np.dtype(array.type.to_pandas_dtype())
    return np.frombuffer(array.buffers()[1], kind, len(array), array.offset * kind.itemsize)


if __name__ == "__main__":
    print(describe_columns())
