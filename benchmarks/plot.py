"""docs/benchmarks.png, in the colours of Okabe and Ito, distinguishable with colour blindness."""

from pathlib import Path

import numpy as np

from benchmarks.table import PARTS, TITLES, Table, number

_COLOURS = {
    "physics": "#000000",
    "engine": "#0072B2",
    "envpool_batch": "#009E73",
    "gymnasium": "#E69F00",
    "reference": "#CC79A7",
    "peer": "#D55E00",
}
_LABELS = {
    "physics": "physics alone",
    "engine": "neol, fast engine",
    "envpool_batch": "EnvPool's stepping alone, in a batch",
    "gymnasium": "Gymnasium's env.step alone",
    "reference": "neol, reference engine",
    "peer": "peer, whole run (neat-python)",
}
_PART_COLOURS = ("#0072B2", "#56B4E9", "#999999", "#E69F00", "#F0E442")
_PART_LABELS = ("network", "plasticity", "environment", "NEAT", "other")


def plot(table: Table, path: Path) -> None:
    """Draw docs/benchmarks.png: times per step, and the shares of a run."""
    import matplotlib

    matplotlib.use("Agg")
    from matplotlib import pyplot as plt

    figure, (times, shares) = plt.subplots(
        1, 2, figsize=(12, 6), width_ratios=(3, 2), sharey=True, layout="constrained"
    )
    places = np.arange(len(table.tasks))
    height = 0.14
    for i, (name, label) in enumerate(_LABELS.items()):
        networks = "" if name == "peer" else "initial"
        widths = [table.get(name, task, networks) or np.nan for task in table.tasks]
        at = places + (i - 2.5) * height
        bars = times.barh(at, widths, height, color=_COLOURS[name], label=label)
        labels = ["" if np.isnan(width) else number(width) for width in widths]
        times.bar_label(bars, labels, fontsize=8, padding=3)
    times.set(xscale="log", xlabel="µs per environment step (one core, log scale)")
    times.set_yticks(places, [TITLES[task] for task in table.tasks])
    times.margins(x=0.15)
    times.invert_yaxis()

    left = np.zeros(len(table.tasks))
    for part, label, colour in zip(PARTS, _PART_LABELS, _PART_COLOURS, strict=True):
        share = np.array([table.get(f"share_{part}", task) or 0.0 for task in table.tasks])
        share = 100 * np.maximum(share, 0.0)  # a difference of two near times may fall below 0
        shares.barh(places, share, 0.6, left=left, color=colour, label=label, edgecolor="white")
        left += share
    shares.set(xlabel="share of a run's CPU time, % (fast engine, P = 50)", xlim=(0, 100))
    for axes in (times, shares):
        axes.spines[["top", "right"]].set_visible(False)
        axes.legend(fontsize=8, loc="lower center", bbox_to_anchor=(0.5, 1.0), ncols=3)
    figure.savefig(path, dpi=150)
    plt.close(figure)
