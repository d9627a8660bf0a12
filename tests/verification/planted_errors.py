"""Errors to plant in a small campaign's folder, each as a function of that folder."""

import dataclasses
import hashlib
import json
import os
import shutil
from collections.abc import Callable
from dataclasses import dataclass
from functools import cache
from pathlib import Path
from typing import Any
from unittest import mock

import numpy as np
import pyarrow as pa
import pyarrow.parquet as pq

from neol.campaign import RESULTS, blocks, run_specs
from neol.errors import UserError
from neol.jobs import Job, jobs
from neol.provenance import Provenance
from neol.record import HeldOut
from neol.records import read_record, write_record
from neol.run import run_block
from neol.spec import canonical_json, load_configuration
from neol.verification.manifest import NAME, Entry, write_manifest
from tests.test_records import forge

Json = dict[str, Any]
Change = Callable[[Json, Json], None]
"""Of a record's metadata and rows."""

MADE_BY = Provenance(
    versions=dict.fromkeys(("python", "numpy", "numba", "neol"), "1.0"),
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
TRIALS = [f"sensitivity/baseline/cartpole_{method}.parquet" for method in ("bcm", "neat")]


def make_campaign(folder: Path) -> None:
    """Three records of budget smoke, nine runs in all, with their manifest."""
    configuration = load_configuration("smoke")
    for block in blocks(configuration):
        name = block.record.relative_to("results/smoke").as_posix()
        if name in (OJA, HEBB, NEAT):
            output = folder / name
            output.parent.mkdir(parents=True)
            specs = run_specs(configuration, block)
            record = run_block(specs[0], block.seeds, output, budget="smoke", engine="reference")
            timeless = {"wall_seconds": 0.0, "cpu_seconds": 0.0}  # same bytes each time
            seeds = tuple(info.model_copy(update=timeless) for info in record.seeds)
            write_record(output, dataclasses.replace(record, seeds=seeds))
    write_manifest(folder)


def patch_budget() -> Any:
    """Let the budget be these three records and a study of two trials; a context manager."""
    return mock.patch("neol.verification.places.jobs", lambda asked: _few(asked.budget.name))


@cache
def _few(budget: str) -> list[Job]:
    names = [RESULTS / budget / name for name in (OJA, HEBB, NEAT, *TRIALS)]
    return [job for job in jobs(load_configuration(budget)) if job.record in names]


def update_manifest(folder: Path, *, add: str = "") -> None:
    """Make a manifest's entries those of its records as they are now, as a careful liar would."""
    path = folder / NAME
    content = json.loads(path.read_text())
    if add:
        content["records"].append({"path": add})
    for entry in content["records"]:
        record = folder / entry["path"]
        try:
            new = Entry.of(entry["path"], record.read_bytes(), read_record(record))
            entry |= new.model_dump(mode="json")
        except UserError:
            entry["sha256"] = hashlib.sha256(record.read_bytes()).hexdigest()
    content["records"].sort(key=lambda entry: entry["path"])
    path.write_text(json.dumps(content))


@dataclass(frozen=True)
class Plant:
    """An error, and what has to find it."""

    kind: str
    """What was done, for the table."""
    do: Callable[[Path], object]
    options: str = ""
    """Of `neol verify`, that it takes to find it; without them it must go unnoticed."""


# --- Bits and bytes of a file; the manifest stays as it was ---------------------------------------


def flip(marker: bytes, offset: int = 0, bit: int = 0) -> Callable[[Path], None]:
    """Flip a bit near the last place where some bytes stand."""

    def do(folder: Path) -> None:
        content = bytearray((folder / OJA).read_bytes())
        content[(content.rindex(marker) + offset) % len(content)] ^= 1 << bit
        (folder / OJA).write_bytes(content)

    return do


def flip_value(folder: Path) -> None:
    """Flip a bit of the last value of the column best_fitness."""
    column = pq.read_metadata(folder / OJA).row_group(0).column(2)
    content = bytearray((folder / OJA).read_bytes())
    content[column.data_page_offset + column.total_compressed_size - 1] ^= 1
    (folder / OJA).write_bytes(content)


def rewrite(change: Callable[[bytes], bytes]) -> Callable[[Path], object]:
    """Change a file's bytes."""
    return lambda folder: (folder / OJA).write_bytes(change((folder / OJA).read_bytes()))


def foreign(folder: Path) -> None:
    pq.write_table(pa.table({"a": [1, 2]}), folder / OJA)


BYTES = [
    Plant("a bit of the opening magic flipped", rewrite(lambda old: b"Q" + old[1:])),
    Plant("a bit of a page's header flipped", rewrite(lambda old: old[:6] + b"\xff" + old[7:])),
    Plant("a bit of a column's values flipped", flip_value),
    Plant("a bit of the metadata flipped", flip(b'"fitness":', 12)),
    Plant("a bit of the record's digest flipped", flip(b"neol_digest", 20)),
    Plant("a bit of the stored schema flipped", flip(b"ARROW:schema", 40)),
    Plant("a bit of the writer's name flipped", flip(b"parquet-cpp", 1)),
    Plant("a bit of the footer's length flipped", flip(b"PAR1", -4)),
    Plant("a bit of the closing magic flipped", flip(b"PAR1", 3)),
    Plant("truncated in the middle", rewrite(lambda old: old[: len(old) // 2])),
    Plant("the last byte lost", rewrite(lambda old: old[:-1])),
    Plant("bytes appended", rewrite(lambda old: old + b"PAR1")),
    Plant("bytes put in front", rewrite(lambda old: b"\0" + old)),
    Plant("emptied", rewrite(lambda _: b"")),
    Plant("replaced by text", rewrite(lambda _: b"seed,generation\n0,1\n")),
    Plant("replaced by another Parquet file", foreign),
]


# --- Contents of a record; record and manifest are sealed anew, so that all hashes are right ------


def edit(change: Change, name: str = OJA) -> Callable[[Path], None]:
    """Change a record, seal it anew, and so the manifest."""

    def do(folder: Path) -> None:
        forge(folder / name, change)
        update_manifest(folder)

    return do


def row(column: str, value: Callable[[Any], Any], generation: int = 2) -> Change:
    """Change a column's value of seed 1 in a generation."""

    def change(_: Json, rows: Json) -> None:
        place = 3 + generation - 1
        rows[column][place] = value(rows[column][place])

    return change


def of_seed(change: Callable[[Json], object]) -> Change:
    """Change what the metadata say of seed 1."""
    return lambda metadata, _: change(metadata["seeds"][1])


def plausible_fitness(_: Json, rows: Json) -> None:
    """A better fitness than there was, within what mean and spread allow."""
    mean, sd = rows["mean_fitness"][4], rows["sd_fitness"][4]
    rows["best_fitness"][4] = float(round(mean + 2.1 * sd))


def exchanged_fitness(_: Json, rows: Json) -> None:
    """Seed 0 gets seed 1's first fitness and the other way round."""
    for name in ("best_fitness", "mean_fitness", "sd_fitness"):
        column = rows[name]
        column[0], column[3] = column[3], column[0]


def reordered_rows(_: Json, rows: Json) -> None:
    for column in rows.values():
        column[3], column[4] = column[4], column[3]


def lost_row(_: Json, rows: Json) -> None:
    for column in rows.values():
        del column[4]


def one_more_row(_: Json, rows: Json) -> None:
    for name, column in rows.items():
        column.append(4 if name == "generation" else column[-1])


def lost_seed(metadata: Json, _: Json) -> None:
    del metadata["seeds"][1]


def doubled_seed(metadata: Json, _: Json) -> None:
    metadata["seeds"][1] = metadata["seeds"][0]


def swapped_seeds(metadata: Json, rows: Json) -> None:
    """The runs of seeds 0 and 1 exchange their numbers, in metadata and rows."""
    one, other = metadata["seeds"][:2]
    one["seed"], other["seed"] = 1, 0
    metadata["seeds"][:2] = other, one
    for name, column in rows.items():
        if name != "seed":
            column[0:3], column[3:6] = column[3:6], column[0:3]


def renamed_seed(metadata: Json, rows: Json) -> None:
    metadata["seeds"][2]["seed"] = 7
    rows["seed"][6:] = [7, 7, 7]


def swapped_champions(metadata: Json, _: Json) -> None:
    one, other = metadata["seeds"][:2]
    one["champion"], other["champion"] = (
        other["champion"] | {"fitness": one["champion"]["fitness"]},
        one["champion"] | {"fitness": other["champion"]["fitness"]},
    )


def edited_spec(metadata: Json, _: Json) -> None:
    metadata["spec"]["neat"]["elitism"] = 1


def seal_spec(metadata: Json) -> None:
    metadata["spec_digest"] = hashlib.sha256(canonical_json(metadata["spec"])).hexdigest()


def edited_spec_and_digest(metadata: Json, rows: Json) -> None:
    edited_spec(metadata, rows)
    seal_spec(metadata)


def cut_short(metadata: Json, rows: Json) -> None:
    metadata["spec"]["evaluation"]["step_limit"] = 10**9
    seal_spec(metadata)
    for column in rows.values():
        del column[5]
    metadata["seeds"][1]["champion"]["fitness"] = rows["best_fitness"][4]


def fewer_seeds(metadata: Json, rows: Json) -> None:
    del metadata["seeds"][2]
    for column in rows.values():
        del column[6:]


def relabelled(metadata: Json, _: Json) -> None:
    metadata["spec"]["task"]["environment"] = "LunarLander-v3"
    seal_spec(metadata)


def learning_without_rule(_: Json, rows: Json) -> None:
    rows["weight_change_mean"][4] = 0.5


def set_held_out(info: Json, returns: list[float]) -> None:
    info["held_out"] = HeldOut.of(np.array(returns)).model_dump(mode="json")


def unsealed(change: Callable[[pa.Table, dict[bytes, bytes]], pa.Table]) -> Callable[[Path], None]:
    """Change a record's table or metadata, and only the manifest's hash after it."""

    def do(folder: Path) -> None:
        file = pq.ParquetFile(folder / OJA)
        metadata = {key: file.metadata.metadata[key] for key in (b"neol", b"neol_digest")}
        table = change(file.read(), metadata)
        pq.write_table(table.replace_schema_metadata(metadata), folder / OJA)
        update_manifest(folder)

    return do


def narrower_column(table: pa.Table, _: dict[bytes, bytes]) -> pa.Table:
    place = table.schema.get_field_index("sd_fitness")
    return table.set_column(place, "sd_fitness", table["sd_fitness"].cast(pa.float32()))


def edited_text(old: bytes, new: bytes) -> Callable[[pa.Table, dict[bytes, bytes]], pa.Table]:
    def change(table: pa.Table, metadata: dict[bytes, bytes]) -> pa.Table:
        assert old in metadata[b"neol"]
        metadata[b"neol"] = metadata[b"neol"].replace(old, new)
        return table

    return change


def last_bit(value: float) -> float:
    return float(np.nextafter(value, np.inf))


def nudge_weight(info: Json) -> None:
    info["champion"]["connections"][0][3] = last_bit(info["champion"]["connections"][0][3])


FIRST, ALL, CHAMPIONS = "--replay 9 --generations 2", "--replay 9", "--replay-champions 9"

CONTENTS = [
    Plant("provenance edited, digest as it was", unsealed(edited_text(b'"1.0"', b'"2.0"'))),
    Plant("a column of another type", unsealed(narrower_column)),
    Plant("a column removed", unsealed(lambda table, _: table.drop_columns("species"))),
    Plant("a column added", unsealed(lambda table, _: table.append_column("x", table["species"]))),
    Plant("another schema version", edit(lambda m, _: m.update(schema_version=2))),
    Plant("an unknown key in the metadata", edit(lambda m, _: m.update(extra=1))),
    Plant("a key of the metadata removed", edit(lambda m, _: m.pop("budget"))),
    Plant("a constant edited", edit(edited_spec)),
    Plant("a constant edited, and the specification's digest", edit(edited_spec_and_digest)),
    Plant("marked as of another budget", edit(lambda m, _: m.update(budget="desk"))),
    Plant("generations in another order", edit(reordered_rows)),
    Plant("a generation lost", edit(lost_row)),
    Plant("a generation too many", edit(one_more_row)),
    Plant("a seed lost from the metadata", edit(lost_seed)),
    Plant("a seed twice in the metadata", edit(doubled_seed)),
    Plant("a seed renamed to one that does not belong there", edit(renamed_seed)),
    Plant("two seeds swapped, rows and metadata", edit(swapped_seeds), FIRST),
    Plant("two seeds' first fitness exchanged", edit(exchanged_fitness), FIRST),
    Plant("NaN in a column", edit(row("mean_fitness", lambda _: float("nan")))),
    Plant("infinity in a column", edit(row("best_fitness", lambda _: float("inf")))),
    Plant("best fitness below the mean", edit(row("best_fitness", lambda _: 0.0))),
    Plant("best fitness out of reach", edit(row("best_fitness", lambda old: old + 100))),
    Plant("best fitness edited plausibly", edit(plausible_fitness), FIRST),
    Plant("the last bit of a mean", edit(row("mean_fitness", last_bit)), FIRST),
    Plant("evaluations edited", edit(row("evaluations", lambda old: old - 1))),
    Plant("environment steps that go back", edit(row("env_steps", lambda _: 3))),
    Plant("environment steps edited plausibly", edit(row("env_steps", lambda old: old + 1)), FIRST),
    Plant("more species than genomes", edit(row("species", lambda _: 7))),
    Plant("species edited plausibly", edit(row("species", lambda _: 2)), FIRST),
    Plant("fewer nodes than outputs", edit(row("nodes_best", lambda _: 1))),
    Plant(
        "connections edited in generation 1", edit(row("connections_best", lambda _: 7, 1)), FIRST
    ),
    Plant("weight change edited", edit(row("weight_change_mean", lambda old: 2 * old)), FIRST),
    Plant("failed evaluations that vanish", edit(row("failed_evaluations", lambda _: -1))),
    Plant("the champion's fitness", edit(of_seed(lambda i: i["champion"].update(fitness=200.0)))),
    Plant("the last bit of a champion's weight", edit(of_seed(nudge_weight)), ALL),
    Plant("two champions exchanged", edit(swapped_champions), CHAMPIONS),
    Plant(
        "a champion's connection from nowhere",
        edit(of_seed(lambda i: i["champion"]["connections"][0].__setitem__(1, 99))),
    ),
    Plant("a seed dropped, rows and metadata", edit(fewer_seeds)),
    Plant("the last generation dropped, under a budget of steps", edit(cut_short)),
    Plant("marked as of another environment", edit(relabelled)),
    Plant("weights that change without a rule", edit(learning_without_rule, NEAT)),
    Plant("a run's number of inputs", edit(of_seed(lambda i: i.update(inputs=3)))),
    Plant("a held-out return lost", edit(of_seed(lambda i: i["held_out"]["returns"].pop()))),
    Plant(
        "a held-out return edited",
        edit(of_seed(lambda i: i["held_out"]["returns"].__setitem__(0, 200.0))),
    ),
    Plant(
        "a held-out return edited, with mean and spread",
        edit(of_seed(lambda i: set_held_out(i, [200.0, *i["held_out"]["returns"][1:]]))),
        CHAMPIONS,
    ),
    Plant(
        "held-out returns exchanged",
        edit(of_seed(lambda i: set_held_out(i, i["held_out"]["returns"][::-1]))),
        CHAMPIONS,
    ),
    Plant("a trajectory's digest", edit(of_seed(lambda i: i.update(digest="0" * 64))), ALL),
]


# --- Files of the folder ------------------------------------------------------------------------


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
        run_block(spec, seeds, folder / OJA, budget=budget, engine="reference")
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


FILES = [
    Plant("a record removed", lambda folder: (folder / OJA).unlink()),
    Plant("a record renamed", move("cartpole/oja/p006_lr0.25/seeds_000-003.parquet")),
    Plant("a record moved to another cell", move("cartpole/oja/p012_lr0.25/seeds_000-002.parquet")),
    Plant("a record copied", move("cartpole/oja/p006_lr0.25/copy.parquet", copy=True)),
    Plant("two records exchanged", exchange),
    Plant("a folder in a record's place", folder_for_file),
    Plant("a pipe in a record's place", pipe),
    Plant("a record dropped, manifest made anew", dropped),
    Plant("another cell's record, manifest made anew", impostor),
    Plant("a record of no known name, manifest made anew", stranger),
    Plant("a run of other constants, manifest made anew", rerun(population=7)),
    Plant("a run of other seeds, manifest made anew", rerun(first=3)),
    Plant("a run of another budget, manifest made anew", rerun("demo")),
]


# --- The manifest -------------------------------------------------------------------------------


def manifest(change: Callable[[Json], object]) -> Callable[[Path], None]:
    def do(folder: Path) -> None:
        content = json.loads((folder / NAME).read_text())
        change(content)
        (folder / NAME).write_text(json.dumps(content))

    return do


def entry(**changes: Any) -> Callable[[Path], None]:
    """Change what it says of the first record."""
    return manifest(lambda content: content["records"][0].update(changes))


MANIFEST = [
    Plant("truncated", lambda folder: (folder / NAME).write_text((folder / NAME).read_text()[:99])),
    Plant("another version", manifest(lambda content: content.update(version=2))),
    Plant("an unknown key", entry(extra=1)),
    Plant("an entry removed", manifest(lambda content: content["records"].pop())),
    Plant("an entry twice", manifest(lambda c: c["records"].append(c["records"][-1]))),
    Plant("entries in another order", manifest(lambda content: content["records"].reverse())),
    Plant("an entry of nothing", entry(path="cartpole/a.parquet")),
    Plant("an entry of a file outside", entry(path="../a.parquet")),
    Plant("an entry's SHA-256", entry(sha256="0" * 64)),
    Plant("an entry's specification", entry(spec_digest="0" * 64)),
    Plant("an entry's seeds", entry(seeds=[0, 1])),
    Plant("an entry's commit", entry(commits=["0" * 40])),
    Plant("the budget", manifest(lambda content: content.update(budget="desk"))),
]

PLANTS = {
    "Bytes of a record": BYTES,
    "Contents of a record, with all hashes computed anew": CONTENTS,
    "Files of a budget's folder": FILES,
    "The manifest": MANIFEST,
}
