"""Known digests of short runs: what a seed gives today it gives tomorrow, with either engine.

They hold where sin, cos, tanh and the physics libraries compute the same last bits: on x86-64
Linux with glibc. A change that alters them on purpose alters every result: renew them with
`python -m tests.test_digests`, and say so in CHANGELOG.md.
"""

import json
import platform
from pathlib import Path

import pytest

from neol.evolution import Evolution
from neol.rollout import EngineChoice, make_engine
from neol.rollout.reference import network_size
from neol.spec import load_configuration

KNOWN = Path(__file__).with_name("digests.json")
RUNS = [
    *(("cartpole", method) for method in ("neat", "neat_wo", "hebb", "oja", "bcm")),
    *((task, "oja") for task in ("lunar_lander", "hopper", "bipedal_walker")),
]
SAME_LAST_BITS = platform.machine() == "x86_64" and platform.libc_ver()[0] == "glibc"


def digest_of(task: str, method: str, engine: EngineChoice) -> str:
    """The trajectory's digest of ten genomes over five generations, with much going on in NEAT."""
    changes = {
        f"tasks.{task}.max_steps": 150,
        "neat.add_node_rate": 0.5,
        "neat.compatibility_threshold": 1.0,
    }
    configuration = load_configuration("paper", [f"{key}={to}" for key, to in changes.items()])
    spec = configuration.run_spec(
        task=task,
        method=method,
        population=10,
        learning_rate=None if method.startswith("neat") else 0.25,
        generations=5,
        seed=7,
    )
    player = make_engine(spec.task, engine)
    evolution = Evolution.begin(spec, *network_size(spec.task))
    list(evolution.run(player))
    player.close()
    return evolution.digest


@pytest.mark.skipif(not SAME_LAST_BITS, reason="the digests were made on x86-64 Linux with glibc")
@pytest.mark.parametrize("engine", ["auto", "reference"])
@pytest.mark.parametrize(("task", "method"), RUNS)
def test_known_digests(task: str, method: str, engine: EngineChoice) -> None:
    known = json.loads(KNOWN.read_text())
    assert digest_of(task, method, engine) == known[f"{task} {method}"]


if __name__ == "__main__":
    digests = {f"{task} {method}": digest_of(task, method, "reference") for task, method in RUNS}
    KNOWN.write_text(json.dumps(digests, indent=2) + "\n")
