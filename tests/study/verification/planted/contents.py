"""Contents of a record; the hashes of it and its manifest are computed again."""

import hashlib
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pyarrow as pa
import pyarrow.parquet as pq

from neol.run.record import HeldOut
from neol.spec.run_spec import canonical_json
from tests.helpers.damage import Json, forge_record
from tests.study.verification.campaign import NEAT, OJA, update_manifest
from tests.study.verification.planted.plant import Plant

Change = Callable[[Json, Json], None]
"""Change of a record's metadata and rows."""


def edit(change: Change, name: str = OJA) -> Callable[[Path], None]:
    """Change a record and compute its digest and the manifest again."""

    def do(folder: Path) -> None:
        forge_record(folder / name, change)
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


def all_fitness(change: Callable[[float], float]) -> Change:
    """Change the best and mean fitness of seed 1 in all generations, and its champion's."""

    def do(metadata: Json, rows: Json) -> None:
        for name in ("best_fitness", "mean_fitness"):
            rows[name][3:6] = map(change, rows[name][3:6])
        metadata["seeds"][1]["champion"]["fitness"] = rows["best_fitness"][5]

    return do


def copied_rows(metadata: Json, rows: Json) -> None:
    """Seed 1 gets the rows of seed 0, with champion and digest."""
    for name, column in rows.items():
        if name != "seed":
            column[3:6] = column[0:3]
    one, other = metadata["seeds"][:2]
    other["champion"], other["digest"] = one["champion"], one["digest"]


def made(**changes: object) -> Change:
    """Change the provenance of seed 1."""
    return of_seed(lambda info: info["provenance"].update(changes))


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


FIRST, ALL = "--replay all --generations 2", "--replay all"
CHAMPIONS = "--replay-champions 9"

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
    Plant("marked as of another reading", edit(lambda m, _: m.update(reading="worked_example"))),
    Plant("generations in another order", edit(reordered_rows)),
    Plant("a generation lost", edit(lost_row)),
    Plant("a generation too many", edit(one_more_row)),
    Plant("a seed lost from the metadata", edit(lost_seed)),
    Plant("a seed twice in the metadata", edit(doubled_seed)),
    Plant("a seed renamed to one that does not belong there", edit(renamed_seed)),
    Plant("two seeds swapped, rows and metadata", edit(swapped_seeds), FIRST),
    Plant("two seeds' first fitness exchanged", edit(exchanged_fitness)),
    Plant("a seed's rows, champion and digest copied over another's", edit(copied_rows)),
    Plant("10,000 more in all generations", edit(all_fitness(lambda old: old + 10_000))),
    Plant("five more in all generations", edit(all_fitness(lambda old: old + 5))),
    Plant("half a return more in all generations", edit(all_fitness(lambda old: old + 0.5))),
    Plant("NaN in a column", edit(row("mean_fitness", lambda _: float("nan")))),
    Plant("infinity in a column", edit(row("best_fitness", lambda _: float("inf")))),
    Plant("best fitness below the mean", edit(row("best_fitness", lambda _: 0.0))),
    Plant("best fitness out of reach", edit(row("best_fitness", lambda old: old + 100))),
    Plant("best fitness edited plausibly", edit(plausible_fitness), FIRST),
    Plant("the last bit of a mean", edit(row("mean_fitness", last_bit)), FIRST),
    Plant("the last bit of the last spread", edit(row("sd_fitness", last_bit, 3)), ALL),
    Plant("evaluations edited", edit(row("evaluations", lambda old: old - 1))),
    Plant("environment steps that go back", edit(row("env_steps", lambda _: 3))),
    Plant("environment steps edited plausibly", edit(row("env_steps", lambda old: old + 1))),
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
    Plant("the last row's network sizes", edit(row("nodes_best", lambda old: old + 1, 3))),
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
        "a held-out return that no episode has, with mean and spread",
        edit(of_seed(lambda i: set_held_out(i, [777.0, *i["held_out"]["returns"][1:]]))),
    ),
    Plant(
        "a fraction of a step's reward, with mean and spread",
        edit(of_seed(lambda i: set_held_out(i, [20.5, *i["held_out"]["returns"][1:]]))),
    ),
    Plant(
        "held-out returns exchanged",
        edit(of_seed(lambda i: set_held_out(i, i["held_out"]["returns"][::-1]))),
        CHAMPIONS,
    ),
    Plant("a trajectory's digest", edit(of_seed(lambda i: i.update(digest="0" * 64))), ALL),
    Plant("a digest that is none", edit(of_seed(lambda i: i.update(digest="hello")))),
    Plant("negative CPU time", edit(of_seed(lambda i: i.update(cpu_seconds=-1.0)))),
    Plant("a time that is none", edit(made(time="yesterday"))),
    Plant("no versions", edit(made(versions={}))),
    Plant("a commit that is in no history", edit(made(commit="f" * 40))),
    Plant("no commit", edit(made(commit=None, dirty=None))),
    Plant("code that differs from its commit", edit(made(dirty=True))),
]
