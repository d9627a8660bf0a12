"""Beside every output a JSON file that leads back from it to its runs."""

import hashlib
import os
from collections.abc import Iterable, Sequence
from pathlib import Path
from typing import Self

from pydantic import ValidationError

from neol.analysis.runs import Source
from neol.errors import UserError
from neol.files import read_bounded, sha256, write_atomically
from neol.model import Model
from neol.provenance import checkout, describe_checkout
from neol.selection import snakemake_options
from neol.spec import ROOT, Configuration, canonical_json

MAX_BYTES = 2**27
INPUTS = ("paper", "notebooks", "rules", "Snakefile", "pyproject.toml")
"""What decides, beside code, constants and records, what tables and figures say."""


def command(output: Path, configuration: Configuration) -> str:
    """What makes an output again, from the root of the checkout."""
    path = os.path.relpath(output.resolve(), ROOT)
    return f"snakemake {path} {snakemake_options(configuration.budget)}"


class Sidecar(Model):
    """What made some outputs: figures/table1.json, of table1.tex and table1.csv beside it."""

    outputs: dict[str, str]
    """SHA-256 by name."""
    command: str
    """That makes them."""
    commit: str | None
    dirty: bool | None
    """Whether code, constants or `INPUTS` differed from that commit; None outside a checkout."""
    budget: str
    configuration: str
    """SHA-256 of the resolved configuration as canonical JSON."""
    records: tuple[Source, ...]

    def code(self, digits: int | None = None) -> str:
        """The commit, so many digits of it; with -dirty where it was not all."""
        return describe_checkout(self.commit, self.dirty, digits)

    @property
    def runs(self) -> int:
        """How many are behind the outputs."""
        return sum(len(record.runs) for record in self.records)

    @classmethod
    def read(cls, path: Path) -> Self:
        """Raises UserError where there is none, or it is damaged."""
        try:
            return cls.model_validate_json(read_bounded(path, MAX_BYTES))
        except ValidationError:
            raise UserError(
                f"{path}: damaged, or made by another version of neol; make it anew"
            ) from None


def write_sidecar(
    outputs: Sequence[Path], configuration: Configuration, sources: Iterable[Source]
) -> None:
    """Write the sidecar of outputs that are there already."""
    resolved = canonical_json(configuration.model_dump(mode="json"))
    commit, dirty = checkout(*INPUTS)
    sidecar = Sidecar(
        outputs={path.name: sha256(path) for path in outputs},
        command=command(outputs[0], configuration),
        commit=commit,
        dirty=dirty,
        budget=configuration.budget.name,
        configuration=hashlib.sha256(resolved).hexdigest(),
        records=tuple(sources),
    )
    text = sidecar.model_dump_json(indent=1) + "\n"
    write_atomically(outputs[0].with_suffix(".json"), text.encode())
