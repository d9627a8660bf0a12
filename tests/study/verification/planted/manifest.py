"""The manifest, edited; the records stay as they were."""

import json
from collections.abc import Callable
from pathlib import Path
from typing import Any

from neol.study.verification.manifest import NAME
from tests.helpers.damage import Json
from tests.study.verification.planted.plant import Plant


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
    Plant("the reading", manifest(lambda content: content.update(reading="worked_example"))),
    Plant("the tasks", manifest(lambda content: content.update(tasks=["hopper"]))),
]
