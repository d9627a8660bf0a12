"""The floors of CONTRIBUTING.md: every module stands on one, and imports from none above it."""

import ast
import re
from collections.abc import Iterator
from graphlib import TopologicalSorter
from pathlib import Path

from neol.spec import ROOT

PACKAGE = ROOT / "neol"
SECTION = "## The floors of the house"


def named() -> list[tuple[str, int]]:
    """Each name of the list with its floor."""
    section = (ROOT / "CONTRIBUTING.md").read_text(encoding="utf-8").split(SECTION)[1]
    items = re.findall(r"^\d+\. (.+(?:\n   .+)*)", section, re.MULTILINE)
    return [
        (name, floor)
        for floor, item in enumerate(items, start=1)
        for name in re.findall(r"`(\w+)/?`", item)
    ]


def imports() -> dict[str, set[str]]:
    """The modules of neol/, its folders as one each, and which others each imports, anywhere."""
    found: dict[str, set[str]] = {}
    for path in PACKAGE.rglob("*.py"):
        name = path.relative_to(PACKAGE).parts[0].removesuffix(".py")
        found.setdefault(name, set()).update(set(imported(path)) - {name})
    return found


def imported(path: Path) -> Iterator[str]:
    for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
        if isinstance(node, ast.Import):
            modules = [alias.name for alias in node.names]
        elif isinstance(node, ast.ImportFrom):
            modules = [f"{node.module}.{alias.name}" for alias in node.names]
        else:
            continue
        yield from (each.split(".")[1] for each in modules if each.startswith("neol."))


def test_every_module_stands_on_one_floor() -> None:
    assert sorted(name for name, _ in named()) == sorted(imports())


def test_none_imports_from_above() -> None:
    floor = dict(named())
    upwards = [
        f"{name} imports {other}"
        for name, others in imports().items()
        for other in others
        if floor[other] > floor[name]
    ]
    assert upwards == []


def test_there_is_no_circle() -> None:
    TopologicalSorter(imports()).prepare()
