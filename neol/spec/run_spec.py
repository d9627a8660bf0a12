"""The specification of a run: everything that its trajectory is a function of."""

import hashlib
import json
from typing import Any

from pydantic import model_validator
from pydantic_core import PydanticCustomError

from neol.spec.constants import (
    Evaluation,
    Neat,
    Network,
    Plasticity,
    Task,
)
from neol.spec.types import Model, PopulationSize, PositiveInt, Seed, Text


class RunSpec(Model):
    """Everything that a run's trajectory is a function of."""

    task: Task
    method: Text
    population: PopulationSize
    """P."""
    generations: PositiveInt
    """G."""
    seed: Seed
    network: Network
    plasticity: Plasticity
    evaluation: Evaluation
    neat: Neat

    @model_validator(mode="after")
    def _agrees(self) -> "RunSpec":
        if not self.plasticity.learns and self.plasticity.learning_rate > 0:
            raise PydanticCustomError("rate", "a learning rate needs a plasticity rule")
        if self.neat.min_species_size > self.population:
            raise PydanticCustomError(
                "species",
                "neat.min_species_size = {size}: must not exceed the population, {population}",
                {"size": self.neat.min_species_size, "population": self.population},
            )
        return self

    def without_seed(self) -> dict[str, Any]:
        """What the runs of a record share, as JSON has it."""
        return self.model_dump(mode="json", exclude={"seed"})

    def digest(self) -> str:
        """SHA-256 in hex of the specification without its seed."""
        return _sha256(self.without_seed())

    def trajectory_key(self) -> str:
        """SHA-256 in hex without `generations`: runs that share it are prefixes of each other."""
        return _sha256(self.model_dump(mode="json", exclude={"generations"}))


def canonical_json(content: Any) -> bytes:
    """The one JSON of a content, whatever the order of its keys."""
    return json.dumps(content, sort_keys=True, separators=(",", ":"), allow_nan=False).encode()


def _sha256(content: Any) -> str:
    return hashlib.sha256(canonical_json(content)).hexdigest()
