"""Known digests of short runs: a seed gives the same run in every version and engine.

They hold where sin, cos, tanh and the physics libraries compute the same last bits: on x86-64
Linux with glibc. A change that alters them on purpose alters every result: renew them with
`python -m tests.run.test_digests`, and say so in CHANGELOG.md.
"""

import json
import os
import platform
import subprocess
import sys
from functools import cache
from pathlib import Path

import pytest

from neol.base.errors import UserError
from neol.rollout import EngineName, make_engine
from neol.rollout.environment import network_size
from neol.rollout.worlds.box2d import library as box2d
from neol.run.evolution import Evolution
from neol.run.record_file import read_record
from neol.spec.configuration import ROOT, load_configuration
from neol.spec.readings import BASE_READING, FIRST_READING
from tests.helpers.core import require_core
from tests.workflow.clone import fresh_clone

KNOWN = Path(__file__).with_name("digests.json")
BOX2D_TASKS = ("lunar_lander", "bipedal_walker", "bipedal_walker_hardcore")
READINGS = (FIRST_READING, BASE_READING)
METHODS = ("neat", "neat_wo", "hebb", "oja", "bcm")
RUNS = [
    *(("cartpole", method) for method in METHODS),
    *((task, method) for task in ("hopper", *BOX2D_TASKS) for method in ("neat", "bcm")),
]
CASES = [
    pytest.param(*run, marks=pytest.mark.slow if "bipedal_walker" in run[0] else ()) for run in RUNS
]
SAME_LAST_BITS = platform.machine() == "x86_64" and platform.libc_ver()[0] == "glibc"

BUSY = ["neat.add_node_rate=0.5", "neat.compatibility_threshold=1.0"]
"""Constants that give hidden nodes, disabled connections and several species."""


@cache
def digest_of(
    task: str, method: str, engine_name: EngineName, reading: str = BASE_READING
) -> tuple[str, str]:
    """A trajectory's digest, and which engine played: ten genomes over ten generations."""
    overrides = [f"tasks.{task}.max_steps=100", *BUSY]
    configuration = load_configuration("paper", overrides, reading=reading)
    spec = configuration.run_spec(
        task=task,
        method=method,
        population=10,
        learning_rate=None if method.startswith("neat") else 0.25,
        generations=10,
        seed=7,
    )
    engine = make_engine(spec.task, engine_name)
    evolution = Evolution.begin(spec, *network_size(spec.task))
    list(evolution.run(engine))
    engine.close()
    assert evolution.state.history[-1].nodes_mean > len(evolution.state.population[0].nodes) / 2
    return evolution.state.digest, engine.name


@pytest.mark.parametrize(("task", "method"), CASES)
def test_either_engine_gives_the_same_trajectory(task: str, method: str) -> None:
    require_core()
    fast, reference = digest_of(task, method, "fast"), digest_of(task, method, "reference")
    assert fast == (reference[0], "fast")


@pytest.mark.skipif(not SAME_LAST_BITS, reason="the digests were made on x86-64 Linux with glibc")
@pytest.mark.parametrize("reading", READINGS)
@pytest.mark.parametrize(("task", "method"), CASES)
def test_known_digests(task: str, method: str, reading: str) -> None:
    known = json.loads(KNOWN.read_text())[reading]
    assert digest_of(task, method, "reference", reading)[0] == known[f"{task} {method}"]


@pytest.mark.skipif(not SAME_LAST_BITS, reason="the digests were made on x86-64 Linux with glibc")
@pytest.mark.parametrize("path", box2d.PATHS)
@pytest.mark.parametrize("task", BOX2D_TASKS)
def test_every_path_of_the_physics_gives_the_known_digest(
    task: str, path: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    if path not in box2d.available_paths(require_core()):
        pytest.skip(f"this machine has no {path}")
    monkeypatch.setenv("NEOL_BOX2D_PATH", path)
    known = json.loads(KNOWN.read_text())["worked_example"]
    played = digest_of.__wrapped__  # without the cached digest
    assert played(task, "bcm", "fast") == (known[f"{task} bcm"], "fast")


@pytest.mark.slow
@pytest.mark.parametrize("task", BOX2D_TASKS)
def test_without_the_core_the_reference_engine_serves(
    task: str,
    monkeypatch: pytest.MonkeyPatch,
    tmp_path: Path,
    capsys: pytest.CaptureFixture[str],
) -> None:
    environment = load_configuration("paper").tasks[task].environment
    expected, _ = digest_of(task, "bcm", "reference")
    missing = box2d.load(tmp_path / "core.so")
    monkeypatch.setattr(box2d, "load", lambda: missing)
    played = digest_of.__wrapped__  # without the cached digest
    assert played(task, "bcm", "auto") == (expected, "reference")
    (notice,) = capsys.readouterr().err.splitlines()
    assert notice.startswith(f"neol: note: the reference engine plays {environment}:")
    with pytest.raises(UserError, match=f"no fast engine for {environment}"):
        played(task, "bcm", "fast")


@pytest.mark.slow
def test_without_a_compiler_a_run_comes_to_the_same_digest(tmp_path: Path) -> None:
    """The build says one line, and so does the run; its record names the engine that played."""
    clone = fresh_clone(tmp_path / "clone")
    (clone / box2d.LIBRARY.relative_to(ROOT)).unlink(missing_ok=True)
    bare = os.environ | {"PYTHONPATH": str(clone), "PATH": str(tmp_path), "CXX": ""}

    def python(module: str, *arguments: str) -> subprocess.CompletedProcess[str]:
        command = [sys.executable, "-m", module, *arguments]
        return subprocess.run(command, cwd=clone, env=bare, capture_output=True, text=True)

    built = python("neol.rollout.worlds.box2d.build")
    assert (built.returncode, built.stderr, built.stdout.count("\n")) == (0, "", 1)
    assert built.stdout.startswith("C++ core not built: no C++ compiler was found; ")

    options = "--task lunar_lander --method bcm --learning-rate 0.25 --seed 7 --max-steps 100"
    options += " --population 10 --generations 10 --budget paper --quiet --output run.parquet"
    options += f" --reading {BASE_READING}"
    run = python("neol", "run", *options.split(), *(f"--set={change}" for change in BUSY))
    assert (run.returncode, run.stderr.count("\n")) == (0, 1), run.stderr
    assert "the reference engine plays LunarLander-v3: its C++ core is not built" in run.stderr
    (seed,) = read_record(clone / "run.parquet").seeds
    expected, _ = digest_of("lunar_lander", "bcm", "reference")
    assert (seed.digest, seed.engine) == (expected, "reference")


if __name__ == "__main__":
    digests = {
        reading: {
            f"{task} {method}": digest_of(task, method, "reference", reading)[0]
            for task, method in RUNS
        }
        for reading in READINGS
    }
    KNOWN.write_text(json.dumps(digests, indent=2) + "\n")
