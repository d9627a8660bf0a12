"""The rows of a record: a column for each of its values, a row for each generation of each seed.

`python -m neol.columns` prints the table of columns that stands in docs/records.md.
"""

from collections.abc import Sequence
from dataclasses import fields
from typing import Any

import numpy as np
import numpy.typing as npt
import pyarrow as pa

from neol.evolution import COLUMNS, Generation

# column: (unit, meaning); the types are those of `Generation`.
DOCUMENTATION = {
    "seed": ("", "The run's seed."),
    "generation": ("", "From 1."),
    "best_fitness": ("return", "Highest fitness of the population: mean return over N episodes."),
    "mean_fitness": ("return", "Mean fitness of the population."),
    "sd_fitness": ("return", "Standard deviation of the population's fitness (ddof = 0)."),
    "evaluations": ("genomes", "Genomes evaluated so far in the run."),
    "env_steps": ("steps", "Environment steps so far in the run, held-out episodes left out."),
    "species": ("species", "Number of species."),
    "nodes_mean": ("nodes", "Mean number of a genome's hidden and output nodes."),
    "connections_mean": ("connections", "Mean number of a genome's enabled connections."),
    "nodes_best": ("nodes", "Hidden and output nodes of the best genome."),
    "connections_best": ("connections", "Enabled connections of the best genome."),
    "weight_change_mean": (
        "weight",
        "Mean \\|w after - w before\\| of an evaluation, over all connections of the population.",
    ),
    "failed_evaluations": (
        "genomes",
        "Evaluations so far that met an observation, reward or weight that was not finite.",
    ),
}
_INTEGERS = {"seed"} | {column.name for column in fields(Generation) if column.type is int}
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
    rows = [
        f"| `{field.name}` | {field.type} | {DOCUMENTATION[field.name][0] or '-'} "
        f"| {DOCUMENTATION[field.name][1]} |"
        for field in SCHEMA
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
