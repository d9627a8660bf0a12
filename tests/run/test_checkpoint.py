"""Checkpoints: exact continuation, and refusal of damaged files."""

import json
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from neol.base.errors import UserError
from neol.neat.genome import CONNECTION
from neol.rollout.reference import ReferenceEngine
from neol.run import checkpoint
from neol.run.checkpoint import Arrays, Past
from neol.run.evolution import Evolution, State
from neol.run.provenance import provenance
from neol.spec.run_spec import RunSpec
from tests.helpers.damage import flipped, forge_checkpoint
from tests.helpers.refusal import survive
from tests.helpers.runs import evolve, run_spec, started

PAST = Past(1.5, 0.75, provenance())


def finish(evolution: Evolution) -> Evolution:
    engine = ReferenceEngine(evolution.spec.task)
    list(evolution.run(engine))
    engine.close()
    return evolution


def state(evolution: Evolution) -> object:
    """Everything that decides how the run goes on, comparable."""
    return comparable(evolution.state)


def comparable(state: State) -> object:
    genomes = [
        (g.id, g.fitness, g.nodes.tolist(), g.connections.tolist()) for g in state.population
    ]
    species = [
        (
            s.id,
            s.representative.id,
            s.representative.nodes.tolist(),
            s.representative.connections.tolist(),
            s.best_fitness,
            s.stagnant,
            s.members.tolist(),
        )
        for s in state.species_set.species
    ]
    innovations = state.innovations
    numbers = state.species_set.next_id, innovations.next_innovation, innovations.next_node
    return genomes, species, numbers, state.history, state.digest


@pytest.mark.parametrize(
    ("method", "innovation"), [("neat", "generation"), ("neat", "endpoints"), ("bcm", "generation")]
)
def test_resumed_after_any_generation_equals_uninterrupted(
    method: str, innovation: str, tmp_path: Path
) -> None:
    overrides = ["neat.compatibility_threshold=0.6", "neat.remove_node_rate=0.1"]
    spec = run_spec(method, 0, *overrides, f"neat.innovation={innovation}", generations=6)
    whole = evolve(spec)
    assert len(whole.state.species_set.species) > 1
    path = tmp_path / "run.npz"
    for generation in range(1, spec.generations + 1):
        before = started(spec, generation)
        checkpoint.write_checkpoint(path, before, PAST)
        after, past = checkpoint.read_checkpoint(path, spec)
        assert state(after) == state(before)
        assert after.state.population.pool.connections.dtype == CONNECTION
        assert past == PAST
        assert state(finish(after)) == state(whole)


def test_a_checkpoint_says_how_far_its_run_is(tmp_path: Path) -> None:
    path = tmp_path / "run.npz"
    assert checkpoint.generations_done(path) == 0
    checkpoint.write_checkpoint(path, started(run_spec(), 2), PAST)
    assert checkpoint.generations_done(path) == 2
    path.write_bytes(path.read_bytes()[:-9])
    assert checkpoint.generations_done(path) == 0


def test_a_state_stays_while_the_run_goes_on() -> None:
    evolution = started(run_spec("oja"), 2)
    kept, before = evolution.state, state(evolution)
    end = state(finish(evolution))
    assert comparable(kept) == before
    evolution.state = kept
    assert state(finish(evolution)) == end


def test_a_longer_run_goes_on_from_a_shorter_ones_checkpoint(tmp_path: Path) -> None:
    path, long = tmp_path / "run.npz", run_spec(generations=6)
    checkpoint.write_checkpoint(path, evolve(run_spec(generations=3)), PAST)
    assert state(finish(checkpoint.read_checkpoint(path, long)[0])) == state(evolve(long))
    with pytest.raises(UserError, match=r"run\.npz: is at generation 3, beyond the last, 2"):
        checkpoint.read_checkpoint(path, run_spec(generations=2))


@pytest.mark.parametrize("other", [run_spec(seed=1), run_spec("hebb"), run_spec(population=9)])
def test_another_runs_checkpoint_is_refused(other: RunSpec, tmp_path: Path) -> None:
    checkpoint.write_checkpoint(tmp_path / "run.npz", started(run_spec(), 1), PAST)
    with pytest.raises(UserError, match=r"run\.npz: a checkpoint of another run.*remove it"):
        checkpoint.read_checkpoint(tmp_path / "run.npz", other)


def test_what_is_no_checkpoint_is_refused(tmp_path: Path) -> None:
    path = tmp_path / "run.npz"
    with pytest.raises(UserError, match=r"run\.npz: cannot be read \(No such file"):
        checkpoint.read_checkpoint(path, run_spec())
    for content in (b"", b"hello", b"PK\x03\x04" + b"x" * 100):
        path.write_bytes(content)
        with pytest.raises(UserError, match="damaged, or not a checkpoint"):
            checkpoint.read_checkpoint(path, run_spec())
    np.savez(path, weights=np.zeros(3))
    with pytest.raises(UserError, match="damaged, or not a checkpoint"):
        checkpoint.read_checkpoint(path, run_spec())
    np.savez(path, seal=np.array([{"a": 1}], dtype=object))
    with pytest.raises(UserError, match="damaged, or not a checkpoint"):
        checkpoint.read_checkpoint(path, run_spec())


@pytest.fixture(scope="module")
def content(tmp_path_factory: pytest.TempPathFactory) -> bytes:
    path = tmp_path_factory.mktemp("checkpoint") / "run.npz"
    checkpoint.write_checkpoint(path, started(run_spec(), 2), PAST)
    return path.read_bytes()


def test_truncated_anywhere_is_refused(content: bytes, tmp_path: Path) -> None:
    path = tmp_path / "run.npz"
    for length in [*range(0, len(content), 397), len(content) - 1]:
        path.write_bytes(content[:length])
        with pytest.raises(UserError, match=r"run\.npz"):
            checkpoint.read_checkpoint(path, run_spec())


@pytest.mark.slow
@settings(max_examples=100, deadline=None)
@given(data=st.data())
def test_damaged_anywhere_is_refused_or_the_same(
    data: st.DataObject, content: bytes, tmp_path_factory: pytest.TempPathFactory
) -> None:
    path = tmp_path_factory.getbasetemp() / "damaged.npz"
    path.write_bytes(data.draw(flipped(content)))
    loaded = survive(lambda: checkpoint.read_checkpoint(path, run_spec()), says="damaged.npz")
    if loaded is not None:  # a byte may mean nothing, such as one of a time in the zip's headers
        assert state(loaded[0]) == state(started(run_spec(), 2))
        assert loaded[1] == PAST


@pytest.mark.parametrize(
    ("name", "field", "value"),
    [("connections", "source", 99), ("nodes", "bias", np.nan), ("members", ..., 0)],
)
def test_an_impossible_state_is_refused_though_sealed(
    name: str, field: Any, value: float, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    pack = checkpoint._pack

    def planted(evolution: Evolution, past: Past) -> checkpoint.Arrays:
        arrays = pack(evolution, past)
        arrays[name][field][-1] = value
        return arrays

    monkeypatch.setattr(checkpoint, "_pack", planted)
    checkpoint.write_checkpoint(tmp_path / "run.npz", started(run_spec(), 1), PAST)
    with pytest.raises(UserError, match=r"run\.npz: damaged: .*; remove it"):
        checkpoint.read_checkpoint(tmp_path / "run.npz", run_spec())


@pytest.mark.parametrize("name", checkpoint.LAYOUT)
@pytest.mark.parametrize("kind", [np.float32, [("id", np.float64)]])
def test_other_types_are_refused_though_sealed(name: str, kind: Any, tmp_path: Path) -> None:
    checkpoint.write_checkpoint(tmp_path / "run.npz", started(run_spec(), 1), PAST)
    forge_checkpoint(
        tmp_path / "run.npz",
        lambda arrays: arrays.update({name: np.zeros(len(arrays[name]), kind)}),
    )
    with pytest.raises(UserError, match=rf"run\.npz: damaged: its {name} are of another type"):
        checkpoint.read_checkpoint(tmp_path / "run.npz", run_spec())


@pytest.mark.parametrize("value", ["8", 8.0, -1, 2**63, None])
def test_impossible_counters_are_refused_though_sealed(value: object, tmp_path: Path) -> None:
    checkpoint.write_checkpoint(tmp_path / "run.npz", started(run_spec(), 1), PAST)

    def change(arrays: Arrays) -> None:
        meta = json.loads(arrays["meta"].tobytes()) | {"next_node": value}
        arrays["meta"] = np.frombuffer(json.dumps(meta).encode(), dtype=np.uint8)

    forge_checkpoint(tmp_path / "run.npz", change)
    with pytest.raises(UserError, match=r"run\.npz: damaged: its next_node is"):
        checkpoint.read_checkpoint(tmp_path / "run.npz", run_spec())


@pytest.mark.parametrize("change", [{"digest": 5}, {"digest": "hello"}, {"cpu_seconds": -1.0}])
def test_other_values_are_refused_though_sealed(change: dict[str, object], tmp_path: Path) -> None:
    checkpoint.write_checkpoint(tmp_path / "run.npz", started(run_spec(), 1), PAST)

    def forge(arrays: Arrays) -> None:
        meta = json.loads(arrays["meta"].tobytes()) | change
        arrays["meta"] = np.frombuffer(json.dumps(meta).encode(), dtype=np.uint8)

    forge_checkpoint(tmp_path / "run.npz", forge)
    with pytest.raises(UserError, match=rf"run\.npz: damaged: its {next(iter(change))} is"):
        checkpoint.read_checkpoint(tmp_path / "run.npz", run_spec())
