"""A small campaign to verify, and its manifest."""

import contextlib
import dataclasses
import hashlib
import json
from collections.abc import Iterator
from functools import cache
from pathlib import Path
from unittest import mock

from neol.base.errors import UserError
from neol.run.provenance import Provenance
from neol.run.record_file import read_record, write_record
from neol.run.runner import run_block
from neol.spec.configuration import load_configuration
from neol.study.campaign.grid import RESULTS, blocks, home, run_specs
from neol.study.campaign.jobs import Job, jobs
from neol.study.verification.manifest import NAME, ManifestEntry, write_manifest

MADE_BY = Provenance(
    versions=dict.fromkeys(("python", "numpy", "numba", "gymnasium", "neol"), "1.0"),
    commit="0123456789abcdef",
    dirty=False,
    host="here",
    platform="Linux-x86_64",
    cpu="2 x some CPU",
    libc="glibc 2.36",
    time="2026-01-01T00:00:00+00:00",
)
OJA, HEBB, NEAT = (
    f"cartpole/{cell}/seeds_000-002.parquet"
    for cell in ("oja/p006_lr0.25", "hebb/p006_lr0.25", "neat/p006")
)
HOPPER = "hopper/neat/p006/seeds_000-002.parquet"
TRIALS = [f"sensitivity/baseline/cartpole_{method}.parquet" for method in ("bcm", "neat")]


def make_campaign(folder: Path) -> None:
    """Three records of budget smoke, nine runs in all, with their manifest."""
    configuration = load_configuration("smoke", reading="first")
    for block in blocks(configuration):
        name = block.record.relative_to(block.home).as_posix()
        if name in (OJA, HEBB, NEAT):
            output = folder / name
            output.parent.mkdir(parents=True)
            specs = run_specs(configuration, block)
            record = run_block(
                specs[0], block.seeds, output, budget="smoke", reading="first", engine="reference"
            )
            timeless = {"wall_seconds": 0.0, "cpu_seconds": 0.0}  # same bytes each time
            seeds = tuple(info.model_copy(update=timeless) for info in record.seeds)
            write_record(output, dataclasses.replace(record, seeds=seeds))
    write_manifest(folder)


@contextlib.contextmanager
def patch_budget(*more: str) -> Iterator[None]:
    """Let the budget be these three records, a study of two trials and what is named.

    And let runs be made by `MADE_BY`, whose commit is in the history.
    """
    verification = "neol.study.verification"
    jobs_of = mock.patch(
        f"{verification}.manifest.jobs",
        lambda asked: _few(asked.budget.name, asked.reading, more),
    )
    history = mock.patch(f"{verification}.history.ancestors", lambda: {MADE_BY.commit})
    begun, ended = (
        mock.patch(f"neol.run.{module}.provenance", return_value=MADE_BY)
        for module in ("single", "runner")
    )
    with jobs_of, history, begun, ended:
        yield


@cache
def _few(budget: str, reading: str, more: tuple[str, ...]) -> list[Job]:
    configuration = load_configuration(budget, reading=reading)
    names = [RESULTS / home(configuration) / name for name in (OJA, HEBB, NEAT, *TRIALS, *more)]
    return [job for job in jobs(configuration) if job.record in names]


def update_manifest(folder: Path, *, add: str = "") -> None:
    """Make a manifest's entries those of its records as they are now, as a careful liar would."""
    path = folder / NAME
    content = json.loads(path.read_text())
    if add:
        content["records"].append({"path": add})
    for entry in content["records"]:
        record = folder / entry["path"]
        try:
            new = ManifestEntry.of(entry["path"], record.read_bytes(), read_record(record))
            entry |= new.model_dump(mode="json")
        except UserError:
            entry["sha256"] = hashlib.sha256(record.read_bytes()).hexdigest()
    content["records"].sort(key=lambda entry: entry["path"])
    path.write_text(json.dumps(content))
