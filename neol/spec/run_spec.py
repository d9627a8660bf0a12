"""The specification of a run: everything that determines its trajectory."""

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
from neol.spec.types import Model, Name, PopulationSize, PositiveInt, Seed

ADDED_LATER: dict[str, dict[str, Any]] = {
    "network": {"activation_scale": 1.0},
    "evaluation": {"episode_seed": "own"},
    "neat": {
        "crossover_enabled": "redraw_if_disabled",
        "distance": "connections",
        "equal_parents": "smaller",
        "innovation": "generation",
        "new_node_bias": "zero",
        "representative": "founder",
    },
}
"""Constants that became switches after the first records, with the value that those records used.

A specification omits a constant that has this value, so those records keep their digests; an
omitted constant has this value.
"""


class RunSpec(Model):
    """Everything that determines a run's trajectory."""

    task: Task
    method: Name
    population: PopulationSize
    """P."""
    generations: PositiveInt
    """G."""
    seed: Seed
    network: Network
    plasticity: Plasticity
    evaluation: Evaluation
    neat: Neat

    @model_validator(mode="before")
    @classmethod
    def _complete(cls, content: Any) -> Any:
        return complete(content) if isinstance(content, dict) else content

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
        if self.neat.crossover_enabled == "stanley" and self.neat.enabled_mutate_rate > 0:
            raise PydanticCustomError(
                "stanley",
                "neat.crossover_enabled = stanley: needs neat.enabled_mutate_rate = 0, because "
                "with both nearly all genes end up disabled",
            )
        return self

    def without_seed(self) -> dict[str, Any]:
        """Return as JSON data what the runs of a record share."""
        return self._json("seed")

    def digest(self) -> str:
        """Return the SHA-256 in hex of the specification without its seed."""
        return _sha256(self.without_seed())

    def trajectory_key(self) -> str:
        """Return the SHA-256 in hex without `generations`; runs that share it share their start."""
        return _sha256(self._json("generations"))

    def _json(self, left_out: str) -> dict[str, Any]:
        content = self.model_dump(mode="json", exclude={left_out})
        for section, old in ADDED_LATER.items():
            for key, value in old.items():
                if content[section][key] == value:
                    del content[section][key]
        return content


def complete(content: dict[str, Any]) -> dict[str, Any]:
    """Return a specification as JSON data with the constants that it omits (`ADDED_LATER`)."""
    return content | {
        section: old | content[section]
        for section, old in ADDED_LATER.items()
        if isinstance(content.get(section), dict)
    }


def canonical_json(content: Any) -> bytes:
    """Return the canonical JSON of a content; the order of its keys does not matter."""
    return json.dumps(content, sort_keys=True, separators=(",", ":"), allow_nan=False).encode()


def _sha256(content: Any) -> str:
    return hashlib.sha256(canonical_json(content)).hexdigest()
