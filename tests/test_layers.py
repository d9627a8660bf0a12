"""Each folder of neol/ is a layer, and imports only from layers below it."""

import ast
import re
from collections.abc import Iterator
from graphlib import TopologicalSorter
from pathlib import Path

import pytest

from neol.spec.configuration import ROOT

LAYERS = re.findall("^.* <- .*$", (ROOT / "CONTRIBUTING.md").read_text(), re.MULTILINE)
"""Layers of neol/ and neol/study/ in CONTRIBUTING.md: `base <- random, network <- ...`."""


def imports(package: Path) -> dict[str, set[str]]:
    """Return each folder of a package with the other folders that its files import."""
    found: dict[str, set[str]] = {}
    for path in sorted(package.glob("*/**/*.py")):
        folder = path.relative_to(package).parts[0]
        found.setdefault(folder, set()).update(set(imported(path, package)) - {folder})
    return found


def imported(path: Path, package: Path) -> Iterator[str]:
    prefix = ".".join(package.relative_to(ROOT).parts) + "."
    for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
        if isinstance(node, ast.Import):
            modules = [alias.name for alias in node.names]
        elif isinstance(node, ast.ImportFrom):
            modules = [f"{node.module}.{alias.name}" for alias in node.names]
        else:
            continue
        yield from (m.removeprefix(prefix).split(".")[0] for m in modules if m.startswith(prefix))


@pytest.mark.parametrize(("line", "package"), [(0, ROOT / "neol"), (1, ROOT / "neol" / "study")])
def test_no_folder_imports_from_its_own_layer_or_above(line: int, package: Path) -> None:
    drawing = LAYERS[line]
    layers = [re.findall(r"\w+", layer) for layer in drawing.split("<-")]
    layer = {folder: number for number, folders in enumerate(layers) for folder in folders}
    found = imports(package)
    folders = {path.parent.name for path in package.glob("*/__init__.py")}
    assert set(layer) == folders == set(found)
    upwards = [
        f"{folder} imports {other}"
        for folder, others in found.items()
        for other in others & folders
        if layer[other] >= layer[folder]
    ]
    assert upwards == []


def test_no_modules_import_in_a_circle() -> None:
    graph: dict[str, set[str]] = {}
    for path in (ROOT / "neol").rglob("*.py"):
        name = ".".join(path.relative_to(ROOT).with_suffix("").parts).removesuffix(".__init__")
        graph[name] = set(top_level_imports(path)) - {name}
    TopologicalSorter(graph).prepare()


def top_level_imports(path: Path) -> Iterator[str]:
    """Return the modules that a module imports when it is itself imported."""
    for node in ast.parse(path.read_text(encoding="utf-8")).body:
        if isinstance(node, ast.ImportFrom) and node.module and node.module.startswith("neol."):
            for alias in node.names:
                file = ROOT / node.module.replace(".", "/") / f"{alias.name}.py"
                yield f"{node.module}.{alias.name}" if file.exists() else node.module
