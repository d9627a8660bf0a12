"""Catalogue of runs: those of all records below a folder."""

from pathlib import Path

import pandas as pd

from neol.base.errors import UserError
from neol.run.record_file import read_record, records_below


def find_records(results: Path) -> list[str]:
    """Return all finished records as paths below the folder. Raises UserError if there is none."""
    found = [str(path.relative_to(results)) for path in records_below(results)]
    if not found:
        raise UserError(f"{results}: contains no record; make some with `snakemake records`")
    return found


def table_of_runs(results: Path) -> pd.DataFrame:
    """Return one row for each run of all records: its configuration, results and cost.

    Raises UserError for a damaged record, or if there is none.
    """
    rows = []
    for name in find_records(results):
        record = read_record(results / name)
        spec = record.spec
        last = record.frame().groupby("seed").last()
        rows += [
            {
                "record": name,
                "budget": record.campaign,
                "sensitivity": "sensitivity" in Path(name).parts,
                "task": spec.task.name,
                "method": spec.method,
                "population": spec.population,
                "learning_rate": spec.plasticity.learning_rate if spec.plasticity.learns else None,
                "generations": spec.generations,
                "seed": info.seed,
                "best_fitness": info.champion.fitness,
                "held_out": info.held_out.mean,
                "env_steps": last.at[info.seed, "env_steps"],
                "connections": last.at[info.seed, "connections_best"],
                "weight_change": last.at[info.seed, "weight_change_mean"],
                "cpu_seconds": info.cpu_seconds,
            }
            for info in record.seeds
        ]
    return pd.DataFrame(rows).astype({"learning_rate": float, "held_out": float})
