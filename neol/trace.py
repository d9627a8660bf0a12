"""From a table or figure back to its runs, readably."""

from collections.abc import Iterator
from pathlib import Path

from neol.analysis.sidecar import Sidecar
from neol.errors import UserError
from neol.files import sha256
from neol.spec import ROOT


def trace(output: Path, root: Path = ROOT) -> Iterator[str]:
    """Lines that say what made an output: command, commit, budget, and each record and its runs.

    The files made together come first. One of them or a record that has changed since, or is not
    there, is marked. Raises UserError where there is no such output, or the JSON file beside it is
    missing or damaged.
    """
    if not output.is_file():
        raise UserError(f"{output}: there is no such file")
    if output.suffix == ".parquet":
        raise UserError(f"{output}: a record, not made from others; ask neol digest for its runs")
    path = output.with_suffix(".json")
    if not path.exists():
        raise UserError(f"{output}: has no {path.name} beside it, so nothing is known of it")
    sidecar = Sidecar.read(path)
    if output.name not in (*sidecar.outputs, path.name):
        raise UserError(f"{output}: not one of the files that {path.name} is about")
    for name, expected in sidecar.outputs.items():
        yield f"{name}{_state(path.parent / name, expected)}"
    yield f"made by  {sidecar.command}"
    yield f"commit   {sidecar.code()}"
    yield f"budget   {sidecar.budget}, configuration {sidecar.configuration[:16]}"
    yield f"records  {len(sidecar.records)}, of {sidecar.runs} runs"
    for record in sidecar.records:
        yield ""
        yield f"{record.path}{_state(root / record.path, record.sha256)}"
        yield f"  sha256 {record.sha256}"
        yield f"  spec   {record.spec}"
        yield from (f"  seed {seed}: {digest}" for seed, digest in record.runs.items())


def _state(path: Path, expected: str) -> str:
    """What has become of a file since."""
    try:
        return "" if sha256(path) == expected else "  (changed since)"
    except UserError:
        return "  (not here)"
