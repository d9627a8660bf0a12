"""docs/benchmarks.md."""

from collections.abc import Mapping

from benchmarks.envpool_steps import batch_of
from benchmarks.measure import RULES
from benchmarks.table import PARTS, TITLES, Table, markdown, number, percent
from benchmarks.targets import targets
from neol.rollout.worlds.box2d.library import PATHS
from neol.study.campaign.cost import NEAT_POPULATION


def page(table: Table, about: Mapping[str, str]) -> str:
    """docs/benchmarks.md."""
    sections = (_targets_section, _engines, _paths, _envpool, _runs, _shares, _kernels, _neat)
    return "\n".join([_head(table, about), *(section(table) for section in sections)])


def _head(table: Table, about: Mapping[str, str]) -> str:
    lines = "".join(f"- {name}: {text}\n" for name, text in about.items())
    return f"""# Benchmarks

<!-- Written by `make bench` (python -m benchmarks.run) from benchmarks.csv: do not edit. -->

{_result(table)}

{lines}
All measurements are from one interleaved run. In every round each contestant is measured once, and
the contestant that begins changes from round to round. Values are medians over the rounds, ratios
are taken within a round; `benchmarks.csv` has their ranges. Times are CPU time of one process,
except the comparison of two workers with one, which is wall time.

![Microseconds per environment step, and where a run's time goes](benchmarks.png)

The bars on the right omit shares below zero and are cut at 100%;
[the table](#where-a-runs-time-goes) has the values.
"""


def _result(table: Table) -> str:
    """Say how fast whole runs are and how many targets are met; explain the page's names."""
    faster = [value for task in table.tasks if (value := table.get("times_faster", task))]
    rows = _target_rows(table)
    met = sum(row[-1] == "met" for row in rows)
    runs = (
        f"a whole run is {min(faster):.0f} to {max(faster):.0f} times as fast as" if faster else ""
    )
    return (
        f"**Result**: {runs or 'no whole run was compared with'} *the peer*, the same algorithm "
        f"written plainly on neat-python and Gymnasium; {met} of {len(rows)} targets are met. A "
        "*path* is a way through Box2D's physics: vector instructions such as avx2, or `shortcut` "
        "without them. *C* is the loop of network and plasticity written in C."
    )


def _target_rows(table: Table) -> list[list[str]]:
    return [row for target in targets() if (row := target.row(table)) is not None]


def _targets_section(table: Table) -> str:
    rows = _target_rows(table)
    header = ("what", "task", "target", "measured", "")
    return f"## Targets\n\n{markdown(header, rows)}"


def _engines(table: Table) -> str:
    header = (
        "task, networks",
        "physics",
        "our engine",
        "of it resets",
        "Gymnasium's env.step",
        "reference engine",
        "engine / physics",
        "without resets",
        "reference / engine",
        "steps of an episode",
    )
    names = ["physics", "engine", "resets", "gymnasium", "reference", "engine_over_physics"]
    names += ["steps_over_physics", "reference_over_engine", "recorded_steps_per_episode"]
    rows = []
    for task in table.tasks:
        for networks in ("initial", "large"):
            cells = [number(table.get(name, task, networks)) for name in names]
            rows.append([f"{TITLES[task]}, {networks}", *cells])
    return f"""## Engines: microseconds per environment step

All contestants play the same recorded episodes.

- *initial*: networks of the initial topology with evolved weights.
- *large*: random networks with 30 hidden nodes and 300 connections.
- *physics*: the unmodified library's steps under the recorded actions (`b2World::Step`, for
  BipedalWalker with its ten ray casts; four `mj_step`).
- *our engine* and the *reference engine* play the episodes with network, plasticity and resets.
- *Gymnasium's env.step* is without networks and resets.

MuJoCo's own profiling, which our engine switches off in the whole process, is off for Gymnasium and
the peer as well.

{markdown(header, rows)}"""


def _paths(table: Table) -> str:
    rows = [
        [
            f"{TITLES[task]}, {networks}",
            number(table.get("physics", task, networks)),
            *(number(table.get(f"engine_{path}", task, networks)) for path in PATHS),
            *(number(table.get(f"engine_{path}_over_physics", task, networks)) for path in PATHS),
        ]
        for task in table.tasks
        for networks in ("initial", "large")
        if table.get("engine_plain", task, networks) is not None
    ]
    header = ["task, networks", "physics", *PATHS, *(f"{path} / physics" for path in PATHS)]
    return f"""## Paths of the engine through Box2D's physics: microseconds per environment step

All paths give the same bits. `plain` is Box2D's own loop, one world at a time. `shortcut` skips
iterations that repeat. The others advance worlds side by side in the lanes of vectors; *our engine*
above is the fastest of them that the processor has. A dash marks a path that this machine lacks.

{markdown(header, rows)}"""


def _envpool(table: Table) -> str:
    header = (
        "task",
        "one environment",
        "environments in a batch",
        "batch",
        "our engine",
        "our engine / the faster",
    )
    rows = [
        [
            TITLES[task],
            number(table.get("envpool_single", task, "initial")),
            str(batch_of(task)),
            *(
                number(table.get(name, task, "initial"))
                for name in ("envpool_batch", "engine", "engine_over_envpool")
            ),
        ]
        for task in table.tasks
    ]
    return f"""## EnvPool's stepping alone: microseconds per environment step

[EnvPool](https://github.com/sail-sg/envpool) steps many environments in C++ and leaves the policy
to other code. Here it runs on one core, with one environment and with a batch of them. It gets the
recorded actions of the networks *initial* above, but plays episodes of its own; its resets are
included. *Our engine* is that of the table above and computes networks and plasticity as well.
EnvPool brings its own MuJoCo (3.6.0).

{markdown(header, rows)}"""


def _runs(table: Table) -> str:
    header = ("task", "G", "neol", "peer", "times faster", "steps an evaluation: neol", "peer")
    names = ("run", "peer", "times_faster", "run_steps_per_evaluation", "peer_steps_per_evaluation")
    rows = [
        [
            TITLES[task],
            f"{table.get('run_generations', task) or 0:.0f}",
            *(number(table.get(name, task)) for name in names),
        ]
        for task in table.tasks
    ]
    return f"""## Whole runs: microseconds per environment step

A run evolves P = 50 networks with Hebb's rule and does everything except writing its record. The
peer (`benchmarks/peer.py`) is the same algorithm written plainly on neat-python and Gymnasium. It
draws other random numbers, so its episodes differ and both sides are counted per step.

{markdown(header, rows)}"""


def _shares(table: Table) -> str:
    header = (
        "task",
        "network",
        "plasticity",
        "environment",
        "NEAT",
        "other",
    )
    rows = [
        [TITLES[task], *(percent(table.get(f"share_{part}", task)) for part in PARTS)]
        for task in table.tasks
    ]
    large = [
        [TITLES[task], *(percent(table.get(f"engine_share_{p}", task, "large")) for p in PARTS[:3])]
        for task in table.tasks
    ]
    return f"""## Where a run's time goes

These are the runs of the table above. NEAT is timed at its calls (decode, write-back, speciate,
reproduce, seeds). Network and plasticity are timed by playing the run's own episodes back in a
world that costs nothing, without and with learning. The environment (physics, resets, observations,
rewards) is what remains of the engine's time; *other* is statistics and digest.

{markdown(header, rows)}
The engine's time divides as follows with large networks (30 hidden nodes, 300 connections):

{markdown(header[:4], large)}"""


def _kernels(table: Table) -> str:
    header = ("task", *(f"{rule}{what}" for rule in RULES for what in ("", ", C", ", ratio")))
    rows = [
        [
            TITLES[task],
            *(
                number(table.get(name, task, networks))
                for rule in RULES
                for name, networks in (
                    (f"kernels_{rule}", "large"),
                    (f"c_{rule}", "large"),
                    (f"kernels_over_c_{rule}", ""),
                )
            ),
        ]
        for task in table.tasks
    ]
    return f"""## Network and plasticity with 300 connections: microseconds per step

Our kernels and the same loop in C (`cc -O3`) play back recorded episodes of the large networks.

{markdown(header, rows)}"""


def _neat(table: Table) -> str:
    parts = ("decode", "encode", "speciate", "reproduce", "seeds")
    header = ("task", "nodes", "connections", "species", *parts, "all", "share of a run")
    rows = [
        [
            TITLES[task],
            *(number(table.get(f"grown_{size}", task)) for size in ("nodes", "connections")),
            number(table.get("grown_species", task)),
            *(number(table.get(f"neat_{part}", task)) for part in (*parts, "generation")),
            percent(table.get("neat_share", task)),
        ]
        for task in table.tasks
    ]
    worker_header = ("task", "one", "two", "outside the engine", "at most", "times faster")
    workers = [
        [
            TITLES[task],
            *(number(table.get(name, task)) for name in ("one_worker", "two_workers")),
            percent(table.get("serial_share", task)),
            *(number(table.get(f"two_workers_{name}", task)) for name in ("bound", "speedup")),
        ]
        for task in table.tasks
    ]
    return f"""## NEAT at P = {NEAT_POPULATION} after 200 generations: milliseconds a generation

Networks grow for 200 generations in which our NEAT, with the task's inputs and outputs, gets random
fitness; then NEAT is timed. *All* is everything that a generation does outside the engine,
including statistics and digest. *Share of a run* compares it with {NEAT_POPULATION} episodes as
long as those of short real runs, at the engine's measured cost of a step with small networks.

{markdown(header, rows)}
## Two workers against one: wall seconds of a run's generations, P = 100

Workers share only the episodes. *Outside the engine* is the share of one worker's CPU time that
NEAT, statistics and digest take; it bounds what a second worker can gain (Amdahl's law). This part
could be shared only partly, because a generation's children are bred from one stream of random
numbers. Two runs with one worker each use two cores better; the workflow does so.

{markdown(worker_header, workers)}
Peak memory is that of a process that makes a whole run of BipedalWalker (the largest genomes), with
P = 300, G = 500 and episodes cut to one step.
"""
