"""Random edits of a small campaign, with all hashes computed again: what finds them.

`python -m tests.study.verification.random_edits SEED COUNT`
"""

import random
import shutil
import sys
import tempfile
from collections import Counter
from pathlib import Path
from typing import Any

import numpy as np

from neol.run.record import HeldOut
from tests.helpers.command import neol
from tests.helpers.damage import Json, forge_record
from tests.study.verification.campaign import (
    HEBB,
    NEAT,
    OJA,
    make_campaign,
    patch_budget,
    update_manifest,
)


def edit(metadata: Json, rows: Json, chance: random.Random) -> None:
    """Change a value of a row, a champion's weight or bias, or a held-out return."""
    info = chance.choice(metadata["seeds"])
    kind = chance.choice(["row", "row", "nodes", "connections", "held-out"])
    if kind == "row":
        column = chance.choice([name for name in rows if name != "seed"])
        place = chance.randrange(len(rows[column]))
        rows[column][place] = changed(rows[column][place], chance)
    elif kind == "held-out":
        returns = info["held_out"]["returns"]
        returns[chance.randrange(len(returns))] += chance.choice([1.0, -1.0, 3.0, 20.0])
        info["held_out"] = HeldOut.of(np.array(returns)).model_dump(mode="json")
    else:
        item = chance.choice(info["champion"][kind])
        item[1 if kind == "nodes" else 3] += chance.choice([1e-12, 0.01, 1.0])


def changed(value: Any, chance: random.Random) -> Any:
    """Another number of the same type."""
    if isinstance(value, int):
        return value + chance.choice([1, -1, 5, 10])
    return value * (1 + chance.choice([1e-15, 1e-6, 0.01, 0.1])) or 1e-3


def found_by(folder: Path) -> str:
    """Return what finds an edit: the check alone, a replay of all runs, or nothing."""
    for options in ("", "--replay all"):
        if neol(f"verify {options}", folder).exit_code == 3:
            return options or "alone"
    return "nothing"


def main(seed: int, count: int) -> None:
    """Print how many edits each of these found."""
    chance = random.Random(seed)
    counts = Counter[str]()
    with tempfile.TemporaryDirectory() as parent, patch_budget():
        make_campaign(Path(parent, "original"))
        for number in range(count):
            folder = Path(parent, str(number))
            shutil.copytree(Path(parent, "original"), folder)
            name = chance.choice([OJA, HEBB, NEAT])
            forge_record(folder / name, lambda metadata, rows: edit(metadata, rows, chance))
            update_manifest(folder)
            counts[found_by(folder)] += 1
    print(dict(counts))


if __name__ == "__main__":
    main(int(sys.argv[1]), int(sys.argv[2]))
