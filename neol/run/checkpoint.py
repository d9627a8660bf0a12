"""Checkpoints: a run in progress as one file, from which it goes on bit for bit.

The file is an .npz without pickles: the genomes' genes end to end, the species, the history, the
counters as JSON, and a digest over all of it.
"""

import hashlib
import io
import json
from copy import copy
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np
import numpy.typing as npt

from neol.base.errors import UserError
from neol.base.files import read_bounded, write_atomically
from neol.neat.genome import CONNECTION, NODE, Genome, Pool, check_genome
from neol.neat.innovations import Innovations
from neol.neat.population import Population
from neol.neat.species import Species, SpeciesSet
from neol.run.evolution import COLUMNS, Evolution, Generation
from neol.spec.run_spec import RunSpec

FORMAT = "neol checkpoint 1"
MAX_BYTES = 2**30

Arrays = dict[str, npt.NDArray[Any]]


@dataclass(frozen=True, slots=True)
class Cost:
    """What a run has cost so far, over all its resumptions."""

    wall_seconds: float = 0.0
    cpu_seconds: float = 0.0
    """Of the process and its threads."""


def snapshot(evolution: Evolution) -> Evolution:
    """The run as it is between two generations; its further steps do not touch the copy.

    The population and the innovations are shared: nobody writes to them any more.
    """
    species_set = evolution.species_set
    return replace(
        evolution,
        reproduction=copy(evolution.reproduction),
        species_set=SpeciesSet([replace(s) for s in species_set.species], species_set.next_id),
        history=list(evolution.history),
    )


def save(path: Path, evolution: Evolution, cost: Cost) -> None:
    """Write a checkpoint of a run between two generations, atomically.

    Raises UserError where it cannot be written.
    """
    arrays = _pack(evolution, cost)
    arrays["seal"] = _seal(arrays)
    buffer = io.BytesIO()
    np.savez(buffer, **arrays)  # type: ignore[arg-type]  # no array is called allow_pickle
    write_atomically(path, buffer.getvalue())


def load(path: Path, spec: RunSpec) -> tuple[Evolution, Cost]:
    """The run that a checkpoint holds, and what it had cost.

    Raises UserError where the file is damaged, no checkpoint, or of another run.
    """
    content = read_bounded(path, MAX_BYTES)
    try:
        with _opened(content) as file:
            arrays = {name: file[name] for name in file.files}
        seal = arrays.pop("seal")
        if not np.array_equal(seal, _seal(arrays)):
            raise ValueError("its content does not match its digest")
        meta = json.loads(arrays["meta"].tobytes())
        if meta["format"] != FORMAT:
            raise ValueError(f"its format is {meta['format']!r}, not {FORMAT!r}")
        key = meta["trajectory_key"]
    except Exception as error:  # whatever a foreign file makes a parser raise
        raise _unusable(path, f"damaged or no checkpoint of neol's: {error}") from None
    if key != spec.trajectory_key():
        raise _unusable(path, "a checkpoint of another run: other constants or another seed")
    try:
        evolution = _unpack(spec, meta, arrays)
        cost = Cost(float(meta["wall_seconds"]), float(meta["cpu_seconds"]))
    except Exception as error:
        raise _unusable(path, f"damaged: {error}") from None
    if evolution.generation > spec.generations:
        raise _unusable(
            path, f"is at generation {evolution.generation}, {spec.generations} were asked for"
        )
    return evolution, cost


def generations(path: Path) -> int:
    """How many generations a checkpoint holds, by its history alone, which is not verified.

    0 where there is none, or it cannot be read.
    """
    try:
        with _opened(read_bounded(path, MAX_BYTES)) as file:
            return len(file[f"history_{COLUMNS[0]}"])
    except Exception:
        return 0


def _opened(content: bytes) -> Any:
    """An .npz file that is no larger unpacked than packed."""
    file = np.load(io.BytesIO(content), allow_pickle=False)
    if sum(member.file_size for member in file.zip.infolist()) > len(content):
        raise ValueError("it would unpack to more than it is")
    return file


def _unusable(path: Path, reason: str) -> UserError:
    line = " ".join(reason.split())[:300]
    return UserError(f"{path}: {line}; remove it and the run starts anew")


def _seal(arrays: Arrays) -> npt.NDArray[np.uint8]:
    """SHA-256 over names, types, shapes and contents: uint8[32]."""
    digest = hashlib.sha256()
    for name in sorted(arrays):
        array = np.ascontiguousarray(arrays[name])
        digest.update(f"{name} {array.dtype.str} {array.shape}\n".encode())
        digest.update(array.data)
    return np.frombuffer(digest.digest(), dtype=np.uint8)


def _pack(evolution: Evolution, cost: Cost) -> Arrays:
    reproduction, species = evolution.reproduction, evolution.species_set.species
    meta = {
        "format": FORMAT,
        "trajectory_key": evolution.spec.trajectory_key(),
        "inputs": reproduction.inputs,
        "outputs": reproduction.outputs,
        "next_genome": reproduction.next_genome,
        "next_innovation": reproduction.innovations.next_innovation,
        "next_node": reproduction.innovations.next_node,
        "next_species": evolution.species_set.next_id,
        "digest": evolution.digest,
        "wall_seconds": cost.wall_seconds,
        "cpu_seconds": cost.cpu_seconds,
    }
    genomes = [*evolution.population, *(s.representative for s in species)]
    pool = Pool.of(genomes)
    integers: dict[str, npt.ArrayLike] = {
        "genome_id": [genome.id for genome in genomes],
        "genome_nodes": np.diff(pool.node_offset),
        "genome_connections": np.diff(pool.connection_offset),
        "species_id": [s.id for s in species],
        "species_stagnant": [s.stagnant for s in species],
        "species_members": [len(s.members) for s in species],
        "members": np.concatenate([s.members for s in species]),
    }
    return {
        "meta": np.frombuffer(json.dumps(meta).encode(), dtype=np.uint8),
        "genome_fitness": np.array([genome.fitness for genome in genomes]),
        "species_best_fitness": np.array([s.best_fitness for s in species]),
        **{name: np.array(values, dtype=np.int64) for name, values in integers.items()},
        **{f"node_{name}": pool.nodes[name] for name in NODE.names or ()},
        **{f"connection_{name}": pool.connections[name] for name in CONNECTION.names or ()},
        **{f"history_{c}": np.array([getattr(g, c) for g in evolution.history]) for c in COLUMNS},
    }


def _unpack(spec: RunSpec, meta: dict[str, Any], arrays: Arrays) -> Evolution:
    """The run that the arrays hold; any exception where they do not fit together."""
    for name in ("inputs", "outputs", *(key for key in meta if key.startswith("next_"))):
        if type(meta[name]) is not int or not 0 <= meta[name] < 2**62:
            raise ValueError(f"its {name} is {meta[name]!r}")
    evolution = Evolution.begin(spec, meta["inputs"], meta["outputs"])
    reproduction = evolution.reproduction
    reproduction.next_genome = meta["next_genome"]
    reproduction.innovations = Innovations.begin(meta["next_innovation"], meta["next_node"])
    genomes = [
        Genome(int(genome_id), nodes, connections, float(fitness))
        for genome_id, nodes, connections, fitness in zip(
            arrays["genome_id"],
            _split(_structured(arrays, "node", NODE), arrays["genome_nodes"]),
            _split(_structured(arrays, "connection", CONNECTION), arrays["genome_connections"]),
            arrays["genome_fitness"],
            strict=True,
        )
    ]
    for genome in genomes:
        check_genome(genome, reproduction.inputs, reproduction.outputs)
    evolution.population = Population.of(genomes[: spec.population])
    founders = genomes[spec.population :]
    if sorted(arrays["members"].tolist()) != list(range(spec.population)):
        raise ValueError("species do not hold each genome once")
    evolution.species_set = SpeciesSet(
        [
            Species(
                int(species_id),
                founder,
                float(best),
                int(stagnant),
                members,
            )
            for species_id, founder, best, stagnant, members in zip(
                arrays["species_id"],
                founders,
                arrays["species_best_fitness"],
                arrays["species_stagnant"],
                _split(arrays["members"], arrays["species_members"]),
                strict=True,
            )
        ],
        meta["next_species"],
    )
    columns = [arrays[f"history_{column}"].tolist() for column in COLUMNS]
    evolution.history = [Generation(*row) for row in zip(*columns, strict=True)]
    evolution.digest = meta["digest"]
    return evolution


def _structured(arrays: Arrays, prefix: str, dtype: np.dtype[np.void]) -> npt.NDArray[np.void]:
    names = dtype.names or ()
    packed = np.zeros(len(arrays[f"{prefix}_{names[0]}"]), dtype=dtype)
    for name in names:
        packed[name] = arrays[f"{prefix}_{name}"]
    return packed


def _split(array: npt.NDArray[Any], counts: npt.NDArray[np.int64]) -> list[npt.NDArray[Any]]:
    """Consecutive parts of an array, each of its own memory."""
    if (counts < 0).any() or counts.sum() != len(array):
        raise ValueError("counts do not fit")
    return [part.copy() for part in np.split(array, np.cumsum(counts)[:-1])]
