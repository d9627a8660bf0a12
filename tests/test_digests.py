"""Known digests of short runs: what a seed gives today it gives tomorrow, with either engine.

They hold where sin, cos, tanh and the physics libraries compute the same last bits: on x86-64
Linux with glibc. A change that alters them on purpose alters every result: renew them with
`python -m tests.test_digests`, and say so in CHANGELOG.md.
"""

import json
import platform
from functools import cache
from pathlib import Path

import pytest

from neol.errors import UserError
from neol.evolution import Evolution
from neol.rollout import EngineChoice, make_engine
from neol.rollout.box2d import library as box2d
from neol.rollout.reference import network_size
from neol.spec import load_configuration
from tests.core import require_core

KNOWN = Path(__file__).with_name("digests.json")
TASKS = ("cartpole", "lunar_lander", "hopper", "bipedal_walker", "bipedal_walker_hardcore")
METHODS = ("neat", "neat_wo", "hebb", "oja", "bcm")
RUNS = [
    *(("cartpole", method) for method in METHODS),
    *((task, method) for task in TASKS[1:] for method in ("neat", "bcm")),
]
SAME_LAST_BITS = platform.machine() == "x86_64" and platform.libc_ver()[0] == "glibc"


@cache
def digest_of(task: str, method: str, choice: EngineChoice) -> tuple[str, str]:
    """A trajectory's digest, and which engine played.

    Ten genomes over ten generations, with much going on in NEAT: hidden nodes, disabled
    connections, several species.
    """
    changes = {
        f"tasks.{task}.max_steps": 100,
        "neat.add_node_rate": 0.5,
        "neat.compatibility_threshold": 1.0,
    }
    configuration = load_configuration("paper", [f"{key}={to}" for key, to in changes.items()])
    spec = configuration.run_spec(
        task=task,
        method=method,
        population=10,
        learning_rate=None if method.startswith("neat") else 0.25,
        generations=10,
        seed=7,
    )
    engine = make_engine(spec.task, choice)
    evolution = Evolution.begin(spec, *network_size(spec.task))
    list(evolution.run(engine))
    engine.close()
    assert evolution.history[-1].nodes_mean > len(evolution.population[0].nodes) / 2
    return evolution.digest, engine.name


@pytest.mark.parametrize(("task", "method"), RUNS)
def test_either_engine_gives_the_same_trajectory(task: str, method: str) -> None:
    require_core()
    fast, reference = digest_of(task, method, "fast"), digest_of(task, method, "reference")
    assert fast == (reference[0], "fast")


@pytest.mark.skipif(not SAME_LAST_BITS, reason="the digests were made on x86-64 Linux with glibc")
@pytest.mark.parametrize(("task", "method"), RUNS)
def test_known_digests(task: str, method: str) -> None:
    known = json.loads(KNOWN.read_text())
    assert digest_of(task, method, "reference")[0] == known[f"{task} {method}"]


def test_without_the_core_the_reference_engine_serves(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    expected = digest_of("lunar_lander", "bcm", "reference")
    missing = box2d.load(tmp_path / "core.so")
    monkeypatch.setattr(box2d, "load", lambda: missing)
    digest_of.cache_clear()
    assert digest_of("lunar_lander", "bcm", "auto") == expected
    (notice,) = capsys.readouterr().err.splitlines()
    assert notice.startswith("neol: note: the reference engine plays LunarLander-v3:")
    with pytest.raises(UserError, match="no fast engine for LunarLander-v3"):
        digest_of("lunar_lander", "bcm", "fast")


if __name__ == "__main__":
    digests = {f"{task} {method}": digest_of(task, method, "reference")[0] for task, method in RUNS}
    KNOWN.write_text(json.dumps(digests, indent=2) + "\n")
