"""Checkpoints: a run in progress as one file, from which it continues bit for bit.

The file is an .npz without pickles: the structured arrays of `LAYOUT`, the counters as JSON, and a
digest over all of it.
"""

import hashlib
import io
import json
import math
import re
from dataclasses import astuple, dataclass
from pathlib import Path
from typing import Any, get_type_hints

import numpy as np
import numpy.typing as npt
from numpy.lib.recfunctions import repack_fields

from neol.base.errors import UserError
from neol.base.files import read_bounded, write_atomically
from neol.neat.genome import CONNECTION, NODE, Genome, check_genome
from neol.neat.population import Population
from neol.neat.species import Species, SpeciesSet
from neol.run.evolution import Evolution, Generation, State
from neol.run.provenance import UNKNOWN, Provenance
from neol.spec.run_spec import RunSpec

FORMAT = "neol checkpoint 2"
MAX_BYTES = 2**30

Arrays = dict[str, npt.NDArray[Any]]
LAYOUT = {
    "genomes": np.dtype([("id", int), ("fitness", float), ("nodes", int), ("connections", int)]),
    "nodes": NODE,
    "connections": repack_fields(CONNECTION),  # without padding, whose bytes are arbitrary
    "species": np.dtype(
        [("id", int), ("best_fitness", float), ("stagnant", int), ("members", int)]
    ),
    "members": np.dtype(int),
    "history": np.dtype(list(get_type_hints(Generation).items())),
}
"""Arrays of a checkpoint. Genomes are those of the population, then the representatives of species.
Each genome has its numbers of nodes and connections, each species its number of members."""


@dataclass(frozen=True, slots=True)
class Past:
    """Cost and provenance of a run so far, over all its resumptions."""

    wall_seconds: float = 0.0
    cpu_seconds: float = 0.0
    """CPU time of the process and its threads."""
    provenance: Provenance | None = None
    """None before the run begins."""


def write_checkpoint(path: Path, evolution: Evolution, past: Past) -> None:
    """Write a checkpoint of a run between two generations, atomically.

    Raises UserError if it cannot be written.
    """
    arrays = _pack(evolution, past)
    arrays["seal"] = _seal(arrays)
    buffer = io.BytesIO()
    np.savez(buffer, **arrays)  # type: ignore[arg-type]  # no array is called allow_pickle
    write_atomically(path, buffer.getvalue())


def read_checkpoint(path: Path, spec: RunSpec) -> tuple[Evolution, Past]:
    """Read a run from a checkpoint, and its cost and provenance so far.

    Raises UserError if the file is damaged, not a checkpoint, or of another run.
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
    except Exception as error:  # a foreign file may make a parser raise anything
        raise _unusable(path, f"damaged, or not a checkpoint of neol: {error}") from None
    if key != spec.trajectory_key():
        raise _unusable(path, "a checkpoint of another run: other constants or another seed")
    try:
        evolution = _unpack(spec, meta, arrays)
        past = Past(float(meta["wall_seconds"]), float(meta["cpu_seconds"]), _provenance(meta))
    except Exception as error:
        raise _unusable(path, f"damaged: {error}") from None
    if evolution.generation > spec.generations:
        raise _unusable(
            path, f"is at generation {evolution.generation}, beyond the last, {spec.generations}"
        )
    return evolution, past


def generations_done(path: Path) -> int:
    """Return the number of generations in a checkpoint, from its unverified history alone.

    0 if there is no checkpoint, or it cannot be read.
    """
    try:
        with _opened(read_bounded(path, MAX_BYTES)) as file:
            return len(file["history"])
    except Exception:
        return 0


def _opened(content: bytes) -> Any:
    """Open an .npz file whose arrays are stored without compression."""
    file = np.load(io.BytesIO(content), allow_pickle=False)
    if sum(member.file_size for member in file.zip.infolist()) > len(content):
        raise ValueError("it would unpack to more than its own size")
    return file


def _unusable(path: Path, reason: str) -> UserError:
    line = " ".join(reason.split())[:300]
    return UserError(f"{path}: {line}; remove it to start the run again")


def _seal(arrays: Arrays) -> npt.NDArray[np.uint8]:
    """Return the SHA-256 over names, types, shapes and contents: uint8[32]."""
    digest = hashlib.sha256()
    for name in sorted(arrays):
        array = np.ascontiguousarray(arrays[name])
        digest.update(f"{name} {array.dtype.str} {array.shape}\n".encode())
        digest.update(array.data)
    return np.frombuffer(digest.digest(), dtype=np.uint8)


def _pack(evolution: Evolution, past: Past) -> Arrays:
    state, species = evolution.state, evolution.state.species_set.species
    meta = {
        "format": FORMAT,
        "trajectory_key": evolution.spec.trajectory_key(),
        "inputs": evolution.reproduction.inputs,
        "outputs": evolution.reproduction.outputs,
        "next_innovation": state.innovations.next_innovation,
        "next_node": state.innovations.next_node,
        "next_species": state.species_set.next_id,
        "digest": state.digest,
        "wall_seconds": past.wall_seconds,
        "cpu_seconds": past.cpu_seconds,
        "provenance": past.provenance and past.provenance.model_dump(mode="json"),
    }
    genomes = [*state.population, *(s.representative for s in species)]
    contents: dict[str, npt.ArrayLike] = {
        "genomes": [(g.id, g.fitness, len(g.nodes), len(g.connections)) for g in genomes],
        "nodes": np.concatenate([g.nodes for g in genomes]),
        "connections": np.concatenate([g.connections for g in genomes]),
        "species": [(s.id, s.best_fitness, s.stagnant, len(s.members)) for s in species],
        "members": np.concatenate([s.members for s in species]),
        "history": [astuple(generation) for generation in state.history],
    }
    arrays = {name: np.array(contents[name], dtype) for name, dtype in LAYOUT.items()}
    return {"meta": np.frombuffer(json.dumps(meta).encode(), dtype=np.uint8), **arrays}


def _provenance(meta: dict[str, Any]) -> Provenance | None:
    """Return the stored provenance; checkpoints of an earlier neol have none."""
    if "provenance" not in meta:
        return UNKNOWN
    stored = meta["provenance"]
    return None if stored is None else Provenance.model_validate_json(json.dumps(stored))


def _unpack(spec: RunSpec, meta: dict[str, Any], arrays: Arrays) -> Evolution:
    """Return the run in the arrays; raises any exception if they do not fit together."""
    for name in ("inputs", "outputs", *(key for key in meta if key.startswith("next_"))):
        if type(meta[name]) is not int or not 0 <= meta[name] < 2**62:
            raise ValueError(f"its {name} is {meta[name]!r}")
    if not isinstance(meta["digest"], str) or not re.fullmatch("[0-9a-f]{64}", meta["digest"]):
        raise ValueError(f"its digest is {meta['digest']!r}")
    for name in ("wall_seconds", "cpu_seconds"):
        if type(meta[name]) is not float or not 0 <= meta[name] < math.inf:
            raise ValueError(f"its {name} is {meta[name]!r}")
    for name, dtype in LAYOUT.items():
        if arrays[name].dtype != dtype or arrays[name].ndim != 1:
            raise ValueError(f"its {name} are of another type")
    genomes = [
        Genome(genome_id, nodes, connections, fitness)
        for (genome_id, fitness, *_), nodes, connections in zip(
            arrays["genomes"].tolist(),
            _split(arrays["nodes"].astype(NODE), arrays["genomes"]["nodes"]),
            _split(arrays["connections"].astype(CONNECTION), arrays["genomes"]["connections"]),
            strict=True,
        )
    ]
    for genome in genomes:
        check_genome(genome, meta["inputs"], meta["outputs"])
    founders = genomes[spec.population :]
    if sorted(arrays["members"].tolist()) != list(range(spec.population)):
        raise ValueError("species do not hold each genome once")
    species = tuple(
        Species(species_id, founder, best_fitness, stagnant, members)
        for (species_id, best_fitness, stagnant, _), founder, members in zip(
            arrays["species"].tolist(),
            founders,
            _split(arrays["members"], arrays["species"]["members"]),
            strict=True,
        )
    )
    evolution = Evolution.begin(spec, meta["inputs"], meta["outputs"])
    evolution.state = State(
        Population.of(genomes[: spec.population]),
        SpeciesSet(species, meta["next_species"]),
        evolution.state.innovations._replace(
            first_innovation=meta["next_innovation"], first_node=meta["next_node"]
        ),
        tuple(Generation(*row) for row in arrays["history"].tolist()),
        meta["digest"],
    )
    return evolution


def _split(array: npt.NDArray[Any], counts: npt.NDArray[np.int64]) -> list[npt.NDArray[Any]]:
    """Copy consecutive parts of an array."""
    if (counts < 0).any() or counts.sum() != len(array):
        raise ValueError("counts do not fit")
    return [part.copy() for part in np.split(array, np.cumsum(counts)[:-1])]
