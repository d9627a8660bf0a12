"""Sidecars: a JSON file beside every output that traces it back to its runs."""

import hashlib
import os
from collections.abc import Iterable, Iterator, Sequence
from pathlib import Path
from typing import Self

from pydantic import ValidationError

from neol.base.errors import UserError
from neol.base.files import read_bounded, sha256, write_atomically
from neol.run.provenance import checkout, describe_checkout
from neol.spec.configuration import ROOT, Configuration
from neol.spec.run_spec import canonical_json
from neol.spec.types import Model
from neol.study.campaign.shown import differs_from_default, snakemake_options
from neol.study.outcomes.campaign_runs import Source

MAX_BYTES = 2**27
INPUTS = ("paper", "notebooks", "rules", "Snakefile", "CITATION.cff")
"""Inputs of tables and figures apart from code, constants and records."""


def command(output: Path, configuration: Configuration) -> str:
    """Return the command that makes an output again, from the root of the checkout."""
    path = os.path.relpath(output.resolve(), ROOT)
    return f"snakemake {path} {snakemake_options(configuration)}"


class Sidecar(Model):
    """Provenance of outputs: figures/table1.json for table1.tex and table1.csv beside it."""

    outputs: dict[str, str]
    """SHA-256 of each output by name."""
    command: str
    """Command that makes the outputs."""
    commit: str | None
    dirty: bool | None
    """Whether code, constants or `INPUTS` differed from the commit; None outside a checkout."""
    budget: str
    reading: str
    differs: dict[str, str]
    """Constants that differ from the default reading, with their values."""
    configuration: str
    """SHA-256 of the resolved configuration as canonical JSON."""
    records: tuple[Source, ...]

    def code(self, digits: int | None = None) -> str:
        """Return the commit's first digits, with -dirty if inputs differed from it."""
        return describe_checkout(self.commit, self.dirty, digits)

    @property
    def run_count(self) -> int:
        """Number of runs that the outputs are made from."""
        return sum(len(record.runs) for record in self.records)

    @classmethod
    def read(cls, path: Path) -> Self:
        """Read a sidecar. Raises UserError if it is missing or damaged."""
        try:
            return cls.model_validate_json(read_bounded(path, MAX_BYTES))
        except ValidationError:
            raise UserError(
                f"{path}: damaged, or made by another version of neol; make it again"
            ) from None


def write_sidecar(
    outputs: Sequence[Path], configuration: Configuration, sources: Iterable[Source]
) -> None:
    """Write the sidecar of existing outputs."""
    resolved = canonical_json(configuration.model_dump(mode="json"))
    commit, dirty = checkout(*INPUTS)
    sidecar = Sidecar(
        outputs={path.name: sha256(path) for path in outputs},
        command=command(outputs[0], configuration),
        commit=commit,
        dirty=dirty,
        budget=configuration.budget.name,
        reading=configuration.reading,
        differs={key: here for key, (here, _) in differs_from_default(configuration).items()},
        configuration=hashlib.sha256(resolved).hexdigest(),
        records=tuple(sources),
    )
    text = sidecar.model_dump_json(indent=1) + "\n"
    write_atomically(outputs[0].with_suffix(".json"), text.encode())


def trace(output: Path, root: Path = ROOT) -> Iterator[str]:
    """Yield lines on the provenance of an output: command, commit, budget, records and runs.

    The files made together come first. Files and records that have changed since or are missing
    are marked. Raises UserError if the output or its sidecar is missing, or the sidecar damaged.
    """
    if not output.is_file():
        raise UserError(f"{output}: no such file")
    if output.suffix == ".parquet":
        raise UserError(f"{output}: a record, made from no other; neol digest lists its runs")
    path = output.with_suffix(".json")
    if not path.exists():
        raise UserError(f"{output}: has no {path.name} beside it, which would state its origin")
    sidecar = Sidecar.read(path)
    if output.name not in (*sidecar.outputs, path.name):
        raise UserError(f"{output}: not one of the files that {path.name} lists")
    for name, expected in sidecar.outputs.items():
        yield f"{name}{_state(path.parent / name, expected)}"
    yield f"made by  {sidecar.command}"
    yield f"commit   {sidecar.code()}"
    changed = ", ".join(f"{key}={value}" for key, value in sidecar.differs.items())
    yield f"reading  {sidecar.reading}{f' ({changed})' if changed else ''}"
    yield f"budget   {sidecar.budget}, configuration {sidecar.configuration[:16]}"
    yield f"records  {len(sidecar.records)}, of {sidecar.run_count} runs"
    for record in sidecar.records:
        yield ""
        yield f"{record.path}{_state(root / record.path, record.sha256)}"
        yield f"  sha256 {record.sha256}"
        yield f"  spec   {record.spec}"
        yield from (f"  seed {seed}: {digest}" for seed, digest in record.runs.items())


def _state(path: Path, expected: str) -> str:
    """Return a remark on a file that has changed or is missing."""
    try:
        return "" if sha256(path) == expected else "  (changed since)"
    except UserError:
        return "  (not here)"
