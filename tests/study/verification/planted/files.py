"""Files of a budget's folder: lost, moved, exchanged, or of other runs."""

import json
import os
import shutil
from collections.abc import Callable
from pathlib import Path
from typing import Any

from neol.run.record_file import read_record
from neol.run.runner import run_block
from neol.study.verification.manifest import NAME, ManifestEntry, write_manifest
from tests.helpers.damage import forge_record
from tests.study.verification.campaign import HEBB, OJA, update_manifest
from tests.study.verification.planted.contents import plausible_fitness
from tests.study.verification.planted.plant import Plant


def exchange(folder: Path) -> None:
    (folder / OJA).rename(folder / "x")
    (folder / HEBB).rename(folder / OJA)
    (folder / "x").rename(folder / HEBB)


def move(target: str, *, copy: bool = False) -> Callable[[Path], None]:
    def do(folder: Path) -> None:
        (folder / target).parent.mkdir(parents=True, exist_ok=True)
        (shutil.copy if copy else shutil.move)(folder / OJA, folder / target)

    return do


def rerun(
    budget: str | None = "smoke", *, first: int = 0, **changes: Any
) -> Callable[[Path], None]:
    """Put a genuine record of another specification, budget or seeds in a record's place."""

    def do(folder: Path) -> None:
        record = read_record(folder / OJA)
        (folder / OJA).unlink()
        spec = record.spec.model_copy(update=changes)
        seeds = range(first, first + 3)
        run_block(spec, seeds, folder / OJA, budget=budget, reading="first", engine="reference")
        update_manifest(folder)

    return do


def dropped(folder: Path) -> None:
    (folder / OJA).unlink()
    write_manifest(folder)


def pipe(folder: Path) -> None:
    (folder / OJA).unlink()
    os.mkfifo(folder / OJA)


def impostor(folder: Path) -> None:
    shutil.copy(folder / HEBB, folder / OJA)
    update_manifest(folder)


def stranger(folder: Path) -> None:
    """A record under a name that no budget has, in the manifest too."""
    name = "cartpole/oja/extra.parquet"
    shutil.copy(folder / OJA, folder / name)
    update_manifest(folder, add=name)


def folder_for_file(folder: Path) -> None:
    (folder / OJA).unlink()
    (folder / OJA).mkdir()


def second_manifest(folder: Path) -> None:
    """An edited record, and beside it a manifest that says so; the real one stays as it was."""
    forge_record(folder / OJA, plausible_fitness)
    below = folder / "cartpole" / "oja"
    content = json.loads((folder / NAME).read_text())
    record = read_record(folder / OJA)
    name = (folder / OJA).relative_to(below).as_posix()
    entry = ManifestEntry.of(name, (folder / OJA).read_bytes(), record)
    content["records"] = [entry.model_dump(mode="json")]
    (below / NAME).write_text(json.dumps(content | {"budget": None}))


def other_campaign(folder: Path) -> None:
    """The whole folder, of budget smoke as its manifest says, as results/first/demo."""
    target = folder / "results" / "first" / "demo"
    target.mkdir(parents=True)
    for part in ("cartpole", NAME):
        (folder / part).rename(target / part)


FILES = [
    Plant("a record removed", lambda folder: (folder / OJA).unlink()),
    Plant("a record renamed", move("cartpole/oja/p006_lr0.25/seeds_000-003.parquet")),
    Plant("a record moved to another cell", move("cartpole/oja/p012_lr0.25/seeds_000-002.parquet")),
    Plant("a record copied", move("cartpole/oja/p006_lr0.25/copy.parquet", copy=True)),
    Plant("two records exchanged", exchange),
    Plant("a folder in a record's place", folder_for_file),
    Plant("a pipe in a record's place", pipe),
    Plant("a second manifest in a folder below, of an edited record", second_manifest),
    Plant("a file that is no record", lambda folder: (folder / "notes.txt").touch()),
    Plant("a run that has not ended", lambda folder: (folder / f"{HEBB}.partial").mkdir()),
    Plant("records in the folder of another budget", other_campaign),
    Plant("a record dropped, manifest made again", dropped),
    Plant("another cell's record, manifest made again", impostor),
    Plant("a record of no known name, manifest made again", stranger),
    Plant("a run of other constants, manifest made again", rerun(population=7)),
    Plant("a run of other seeds, manifest made again", rerun(first=3)),
    Plant("a run of another budget, manifest made again", rerun("demo")),
]
