"""Table of medians from measured values: ratios, shares, and the format of numbers."""

from collections.abc import Callable, Iterable, Mapping, Sequence

import numpy as np
import numpy.typing as npt
import pandas as pd

from benchmarks.measure import RULES
from neol.rollout.worlds.box2d.library import PATHS
from neol.study.campaign.cost import NEAT_POPULATION

Key = tuple[str, str, str]
"""Quantity, task, networks; empty for no particular task or networks."""
Array = npt.NDArray[np.float64]
Rounds = Mapping[Key, list[float]]
"""Measured values by key: one for each round."""
Get = Callable[..., Array]

TITLES = {
    "cartpole": "CartPole",
    "lunar_lander": "LunarLander",
    "hopper": "Hopper",
    "bipedal_walker": "BipedalWalker",
}
PARTS = ("network", "plasticity", "environment", "neat", "other")


def summarise(values: Rounds) -> pd.DataFrame:
    """Return median, least and greatest over the rounds of everything measured and derived."""
    everything: dict[Key, Sequence[float] | Array] = {**values, **_derived(values)}
    rows = [
        {
            "quantity": quantity,
            "task": task,
            "networks": networks,
            "median": float(np.median(measured)),
            "minimum": float(np.min(measured)),
            "maximum": float(np.max(measured)),
            "rounds": len(measured),
        }
        for (quantity, task, networks), measured in everything.items()
    ]
    return pd.DataFrame(rows)


def _derived(values: Rounds) -> dict[Key, Array]:
    """Derive ratios and shares, each within a round."""
    derived: dict[Key, Array] = {}
    for task in dict.fromkeys(task for _, task, _ in values):

        def get(quantity: str, networks: str = "", task: str = task) -> Array:
            return np.array(values.get((quantity, task, networks), [0.0]))

        for networks in ("initial", "large"):
            for name, value in _engine_ratios(get, networks).items():
                derived[name, task, networks] = value
        for name, value in {**_run_ratios(get), **_kernel_ratios(get)}.items():
            derived[name, task, ""] = value
    return derived


def _engine_ratios(get: Get, networks: str) -> dict[str, Array]:
    engine, physics = get("engine", networks), get("physics", networks)
    ratios = {
        "gymnasium_over_engine": get("gymnasium", networks) / engine,
        "reference_over_engine": get("reference", networks) / engine,
    }
    if physics.any():
        ratios["engine_over_physics"] = engine / physics
        ratios["steps_over_physics"] = (engine - get("resets", networks)) / physics
        for path in PATHS:
            if (on_path := get(f"engine_{path}", networks)).any():
                ratios[f"engine_{path}_over_physics"] = on_path / physics
    if get("envpool_batch", networks).any():
        fastest = np.minimum(get("envpool_single", networks), get("envpool_batch", networks))
        ratios["engine_over_envpool"] = engine / fastest
    known = {part: get(part, networks) / engine for part in ("network", "plasticity")}
    known["environment"] = 1.0 - np.sum(list(known.values()), axis=0)
    return ratios | {f"engine_share_{part}": share for part, share in known.items()}


def _run_ratios(get: Get) -> dict[str, Array]:
    run = get("run")
    shares = {part: get(f"run_{part}") / run for part in ("network", "plasticity", "neat", "other")}
    shares["environment"] = 1.0 - np.sum(list(shares.values()), axis=0)
    steps = get("short_run_late_steps", "hebb")
    generation = get("neat_generation") * 1e-3
    episodes = NEAT_POPULATION * steps * get("engine", "initial") * 1e-6
    return {f"share_{part}": share for part, share in shares.items()} | {
        "times_faster": get("peer") / run,
        "two_workers_speedup": get("one_worker") / get("two_workers"),
        "two_workers_bound": 2.0 / (1.0 + get("serial_share")),  # Amdahl's law
        "neat_share": generation / (generation + episodes),
    }


def _kernel_ratios(get: Get) -> dict[str, Array]:
    ratios = {
        f"kernels_over_c_{rule}": get(f"kernels_{rule}", "large") / get(f"c_{rule}", "large")
        for rule in RULES
    }
    worst = np.max([get(f"kernels_{rule}", "large") for rule in RULES], axis=0)
    return ratios | {
        "kernels_worst": worst,
        "kernels_over_c_worst": np.max(list(ratios.values()), axis=0),
    }


class Table:
    """Return a measured median by quantity, task and networks; None if not measured."""

    def __init__(self, frame: pd.DataFrame) -> None:
        keys = zip(frame["quantity"], frame["task"], frame["networks"], strict=True)
        self._median: dict[Key, float] = dict(zip(keys, frame["median"].tolist(), strict=True))
        self.tasks = [task for task in TITLES if task in set(frame["task"])]

    def get(self, quantity: str, task: str, networks: str = "") -> float | None:
        return self._median.get((quantity, task, networks))


def number(value: float | None) -> str:
    """Format a value with three digits, or a dash if it was not measured."""
    if value is None:
        return "–"
    if abs(value) >= 100:
        return f"{value:,.0f}"
    return f"{value:.1f}" if abs(value) >= 10 else f"{value:.2f}"


def percent(value: float | None) -> str:
    return "–" if value is None else f"{100 * value:.1f}%"


def markdown(header: Iterable[str], rows: Iterable[Iterable[str]]) -> str:
    """Return a Markdown table, the first column aligned left and the others right."""
    header = list(header)
    lines = [header, ["---", *["---:"] * (len(header) - 1)], *rows]
    return "\n".join(f"| {' | '.join(line)} |" for line in lines) + "\n"
