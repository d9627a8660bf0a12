"""The effect of each constant that the paper leaves open, compared with the baseline's runs."""

from pathlib import Path

import numpy as np
import pandas as pd

from neol.base.errors import UserError
from neol.spec.configuration import Configuration
from neol.study.campaign.grid import RESULTS
from neol.study.campaign.variants import BASELINE, Trial, trials, variants
from neol.study.outcomes.campaign_runs import Source
from neol.study.outcomes.statistics import Floats, estimate


def sensitivity(
    configuration: Configuration, results: Path = RESULTS, seed: int = 0
) -> tuple[pd.DataFrame, tuple[Source, ...]]:
    """Compare each variant's held-out return with the baseline's; return a table and its records.

    The training maximum is not comparable: a variant can change what it measures (N). A variant's
    run shares its seed with one of the baseline, so `a12` is of these pairs: the share in which the
    variant's run ends higher, ties counting half, with the interval of a bootstrap over pairs. Runs
    that are the same give exactly 1/2. `difference` is the pairs' mean difference. A row for each
    variant, task and method, with its `seeds` and how many are `planned`, those `without_value` (a
    champion that failed in all fresh episodes), the `pairs` that remain, and how many of the runs
    are the `same` as the baseline's in each number of each generation: there the constant acted on
    nothing.
    Missing runs give NaN.
    """
    random = np.random.default_rng(seed)
    samples: dict[tuple[str, str, str], pd.Series[float]] = {}
    histories: dict[tuple[str, str, str], dict[int, pd.DataFrame]] = {}
    sources: list[Source] = []
    rows = []
    for name in variants():
        for trial in trials(configuration, name):
            place, baseline = ((each, trial.task, trial.method) for each in (name, BASELINE))
            samples[place], histories[place], source = _read(trial, results)
            sources += source
            sample = samples[place]
            pairs = (sample - samples[baseline]).dropna()  # aligned by seed
            same = sum(
                seed in histories[baseline] and history.equals(histories[baseline][seed])
                for seed, history in histories[place].items()
            )
            a12 = estimate(_mean, [(np.sign(pairs.to_numpy()) + 1) / 2], random)
            values = a12.value, a12.low, a12.high
            counts = len(sample), len(trial.seeds), int(sample.isna().sum()), len(pairs), same
            rows.append((*place, *counts, sample.mean(), *values, pairs.mean()))
    counts_of = ["seeds", "planned", "without_value", "pairs", "same"]
    effect = ["mean", "a12", "low", "high", "difference"]
    columns = ["variant", "task", "method", *counts_of, *effect]
    return pd.DataFrame(rows, columns=columns), tuple(sources)


def _read(
    trial: Trial, results: Path
) -> tuple["pd.Series[float]", dict[int, pd.DataFrame], list[Source]]:
    """Return the champions' held-out means and the generations by seed, and the record."""
    path = results / trial.record
    if not path.exists():
        return pd.Series(dtype=np.float64), {}, []
    record, source = Source.read(results, trial.record, trial.spec)
    if [info.seed for info in record.seeds] != list(trial.seeds):
        raise UserError(
            f"{path}: does not hold seeds {trial.seeds[0]} to {trial.seeds[-1]}, those of the "
            "study; remove it and run again"
        )
    held_out = {info.seed: info.held_out.mean for info in record.seeds}
    frame = record.frame()
    histories = {
        info.seed: frame[frame["seed"] == info.seed].reset_index(drop=True) for info in record.seeds
    }
    return pd.Series(held_out, dtype=np.float64), histories, [source]


def _mean(sample: Floats) -> Floats:
    return np.asarray(sample.mean(axis=-1))
