"""The public names of `import neol`."""

import ast
import doctest
import importlib.metadata
import os
import subprocess
import sys
from pathlib import Path

import pytest

import neol
from neol.spec.configuration import ROOT


def in_a_process(script: str, folder: Path = ROOT) -> str:
    done = subprocess.run(
        [sys.executable, "-c", script],
        cwd=folder,
        env=os.environ | {"PYTHONPATH": str(ROOT)},
        capture_output=True,
        text=True,
    )
    assert done.returncode == 0, done.stdout + done.stderr
    return done.stdout


@pytest.mark.slow
def test_the_examples_work(tmp_path: Path) -> None:
    (tmp_path / "runs").mkdir()
    options = doctest.ELLIPSIS | doctest.NORMALIZE_WHITESPACE
    script = f"import doctest, neol; print(doctest.testmod(neol, optionflags={options}))"
    assert in_a_process(script, tmp_path).startswith("TestResults(failed=0, attempted=1")


def test_the_version_is_the_installed_one() -> None:
    assert neol.__version__ == importlib.metadata.version("neol")


def test_a_type_checker_sees_the_names_that_there_are() -> None:
    assert neol.__file__ is not None
    tree = ast.parse(Path(neol.__file__).read_text())
    seen = {
        node.module: tuple(alias.name for alias in node.names)
        for node in ast.walk(tree)
        if isinstance(node, ast.ImportFrom) and node.module != "typing"
    }
    assert seen == neol._MODULES
    assert sorted(name for names in seen.values() for name in names) == neol.__all__
    assert (Path(neol.__file__).parent / "py.typed").exists()


@pytest.mark.parametrize("name", neol.__all__)
def test_every_name_is_there_and_documented(name: str) -> None:
    assert getattr(neol, name).__doc__
    assert f"neol.{name}" in (neol.__doc__ or "") or isinstance(getattr(neol, name), type)


def test_a_name_that_is_none() -> None:
    with pytest.raises(AttributeError, match="module neol has no attribute 'evolv'"):
        neol.evolv  # noqa: B018


def test_importing_it_loads_nothing() -> None:
    loaded = in_a_process("import neol, sys; print([m for m in sys.modules if 'neol' in m])")
    assert loaded.strip() == "['neol']"
