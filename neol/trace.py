"""From a table or figure back to its runs, readably."""

import hashlib
import json
from collections.abc import Iterator
from pathlib import Path
from typing import Any

from neol.errors import UserError
from neol.files import read_bounded
from neol.spec import ROOT

MAX_BYTES = 2**27


def trace(output: Path, root: Path = ROOT) -> Iterator[str]:
    """Lines that say what made an output: command, commit, budget, and each record and its runs.

    A record that has changed since, or is not there, is marked. Raises UserError where the JSON
    file beside the output is missing or damaged.
    """
    path = output.with_suffix(".json")
    if not path.exists():
        raise UserError(f"{output}: has no {path.name} beside it, so nothing is known of it")
    try:
        sidecar = json.loads(read_bounded(path, MAX_BYTES))
        records = sidecar["records"]
        dirty = ", with changes that were not committed" if sidecar["dirty"] else ""
        yield f"{output.name}"
        yield f"made by  {sidecar['command']}"
        yield f"commit   {sidecar['commit'] or 'unknown'}{dirty}"
        yield f"budget   {sidecar['budget']}, configuration {sidecar['configuration'][:16]}"
        yield f"records  {len(records)}, of {sum(len(each['runs']) for each in records)} runs"
        for record in records:
            yield ""
            yield f"{record['path']}{_state(record, root)}"
            yield f"  sha256 {record['sha256']}"
            yield f"  spec   {record['spec']}"
            yield from (f"  seed {seed}: {digest}" for seed, digest in record["runs"].items())
    except (ValueError, KeyError, TypeError, AttributeError):
        raise UserError(f"{path}: damaged, or not made by this project") from None


def _state(record: dict[str, Any], root: Path) -> str:
    """What has become of a record since."""
    path = root / record["path"]
    if not path.is_file():
        return "  (not here)"
    same = hashlib.sha256(path.read_bytes()).hexdigest() == record["sha256"]
    return "" if same else "  (changed since)"
