"""Targets of the measured values."""

from dataclasses import dataclass

from benchmarks.table import TITLES, Table, number, percent
from neol.study.campaign.cost import NEAT_POPULATION


@dataclass(frozen=True)
class Target:
    """A bound on a measured quantity."""

    what: str
    quantity: str
    task: str
    bound: float
    at_least: bool = False
    networks: str = ""
    unit: str = ""
    or_else: tuple[str, float] | None = None
    """Alternative quantity and its upper bound; one of the two suffices."""

    def row(self, table: Table) -> list[str] | None:
        value = table.get(self.quantity, self.task, self.networks)
        if value is None:
            return None
        show = percent if self.unit == "%" else lambda v: f"{number(v)}{self.unit}"
        met = value >= self.bound if self.at_least else value <= self.bound
        bound = f"{'≥' if self.at_least else '≤'} {show(self.bound)}"
        measured = show(value)
        if self.or_else is not None:
            name, limit = self.or_else
            other = table.get(name, self.task, self.networks)
            assert other is not None
            met |= other <= limit
            bound += f" or ≤ {number(limit)} × C"
            measured += f", {number(other)} × C"
        return [self.what, TITLES[self.task], bound, measured, "met" if met else "**missed**"]


def targets() -> list[Target]:
    """Return all targets, as ratios in one interleaved run."""
    faster = {"cartpole": 80, "lunar_lander": 18, "bipedal_walker": 12, "hopper": 3}
    neat = {"lunar_lander": 0.06, "hopper": 0.01, "bipedal_walker": 0.01, "cartpole": 0.4}
    physics = {
        "lunar_lander": {"avx2": 0.25, "shortcut": 0.6},
        "bipedal_walker": {"avx2": 0.4, "shortcut": 0.85},
    }
    return [
        *(
            Target("whole run: times as fast as the peer", "times_faster", task, bound, True)
            for task, bound in faster.items()
        ),
        *(
            Target(
                f"engine on path {path} / physics of the unmodified library",
                f"engine_{path}_over_physics",
                task,
                bound,
                networks="initial",
            )
            for task, bounds in physics.items()
            for path, bound in bounds.items()
        ),
        Target(
            "engine / physics of the unmodified library",
            "engine_over_physics",
            "hopper",
            0.92,
            networks="initial",
        ),
        *(
            Target(
                "engine / EnvPool's stepping alone",
                "engine_over_envpool",
                task,
                1.1 if task == "hopper" else 1.0,
                networks="initial",
            )
            for task in TITLES
        ),
        *(
            Target(f"NEAT's share at P = {NEAT_POPULATION}", "neat_share", task, bound, unit="%")
            for task, bound in neat.items()
        ),
        *(
            Target(
                "network and plasticity, 300 connections, costliest rule",
                "kernels_worst",
                task,
                1.5,
                unit=" µs",
                or_else=("kernels_over_c_worst", 1.3),
            )
            for task in TITLES
        ),
        *(
            Target("two workers against one, P = 100", "two_workers_speedup", task, 1.85, True)
            for task in TITLES
            if task != "cartpole"
        ),
        Target("peak memory of a run, P = 300", "peak_memory", "bipedal_walker", 400, unit=" MB"),
    ]
