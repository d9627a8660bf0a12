"""How much each constant that the paper leaves open matters, against the baseline's runs."""

import hashlib
import math
from pathlib import Path

import numpy as np
import pandas as pd

from neol.analysis.runs import Source
from neol.analysis.statistics import Floats, estimate, superiority
from neol.campaign import RESULTS
from neol.records import read_record
from neol.sensitivity import BASELINE, Trial, trials, variants
from neol.spec import Configuration


def sensitivity(
    configuration: Configuration, results: Path = RESULTS, seed: int = 0
) -> tuple[pd.DataFrame, tuple[Source, ...]]:
    """Final best fitness of each variant: mean, and A12 against the baseline with interval.

    A row for each variant, task and method; runs that are not there give NaN. And their records.
    """
    random = np.random.default_rng(seed)
    samples: dict[tuple[str, str, str], Floats] = {}
    sources: list[Source] = []
    rows = []
    for name in variants():
        for trial in trials(configuration, name):
            sample, source = _read(trial, results)
            samples[name, trial.task, trial.method] = sample
            sources += source
            a12 = estimate(
                superiority, [sample, samples[BASELINE, trial.task, trial.method]], random
            )
            mean = float(sample.mean()) if len(sample) else math.nan
            rows.append(
                (name, trial.task, trial.method, len(sample), mean, a12.value, a12.low, a12.high)
            )
    columns = ["variant", "task", "method", "seeds", "mean", "a12", "low", "high"]
    return pd.DataFrame(rows, columns=columns), tuple(sources)


def describe_trials(configuration: Configuration) -> str:
    """How the variants were run, in a sentence, for captions."""
    first, *others = trials(configuration, BASELINE)
    rate = max(trial.spec.plasticity.learning_rate for trial in (first, *others))
    return (
        f"Sensitivity runs of budget {configuration.budget.name}: G = {first.spec.generations} "
        f"generations, population {first.spec.population}, learning rate {rate:g}, "
        f"{len(first.seeds)} seeds that no table uses."
    )


def _read(trial: Trial, results: Path) -> tuple[Floats, list[Source]]:
    """A trial's final best fitness by seed, and its record; nothing where there is none."""
    below = trial.record.relative_to(RESULTS)
    path = results / below
    if not path.exists():
        return np.array([]), []
    record = read_record(path, trial.spec)
    final = record.table.to_pandas().groupby("seed")["best_fitness"].last()
    source = Source(
        path=str(Path(results.resolve().name, below)),
        sha256=hashlib.sha256(path.read_bytes()).hexdigest(),
        spec=record.spec_digest,
        runs={info.seed: info.digest for info in record.seeds},
    )
    return final.to_numpy(dtype=np.float64), [source]
