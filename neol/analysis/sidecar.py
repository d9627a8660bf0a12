"""Beside every output a JSON file that leads back from it to its runs."""

import hashlib
import json
import os
from collections.abc import Iterable, Sequence
from dataclasses import asdict
from pathlib import Path

from neol.analysis.runs import Source
from neol.files import write_atomically
from neol.provenance import provenance
from neol.spec import ROOT, Configuration


def command(output: Path, configuration: Configuration) -> str:
    """What makes an output again, from the root of the checkout."""
    path = os.path.relpath(output.resolve(), ROOT)
    return f"snakemake {path} --config budget={configuration.budget.name}"


def write_sidecar(
    outputs: Sequence[Path], configuration: Configuration, sources: Iterable[Source]
) -> None:
    """Write figures/table1.json for figures/table1.tex and its table1.csv, which are there already.

    Its keys: `outputs` (SHA-256 by name); `command` that makes them; `commit` and whether the
    checkout was `dirty`; `budget`; `configuration` (SHA-256 of the resolved configuration as
    canonical JSON); `records`, each with `path`, `sha256` of the file, `spec` (the specification's
    digest) and `runs` (trajectory digest by seed).
    """
    resolved = json.dumps(configuration.model_dump(mode="json"), sort_keys=True)
    made_by = provenance()
    content = {
        "outputs": {path.name: hashlib.sha256(path.read_bytes()).hexdigest() for path in outputs},
        "command": command(outputs[0], configuration),
        "commit": made_by.commit,
        "dirty": made_by.dirty,
        "budget": configuration.budget.name,
        "configuration": hashlib.sha256(resolved.encode()).hexdigest(),
        "records": [asdict(source) for source in sources],
    }
    text = json.dumps(content, indent=1) + "\n"
    write_atomically(outputs[0].with_suffix(".json"), text.encode())
