"""The code never executes the content of a file or a parameter."""

import ast
from pathlib import Path

import pytest

from neol.spec.configuration import ROOT

FORBIDDEN_MODULES = {"pickle", "cPickle", "marshal", "shelve", "dill", "cloudpickle", "joblib"}
FORBIDDEN_CALLS = {
    "eval",
    "exec",
    "compile",
    "__import__",
    "read_pickle",
}


def dangers(source: str) -> list[str]:
    """Return calls and imports that could execute the content of a file."""
    found = []
    for node in ast.walk(ast.parse(source)):
        if isinstance(node, ast.Import | ast.ImportFrom):
            names = [alias.name for alias in node.names] + [getattr(node, "module", None) or ""]
            found += [name for name in names if name.split(".")[0] in FORBIDDEN_MODULES]
        if not isinstance(node, ast.Call):
            continue
        name = node.func.attr if isinstance(node.func, ast.Attribute) else ast.unparse(node.func)
        call = ast.unparse(node)
        wrong = (
            (name in FORBIDDEN_CALLS and node.args and ast.unparse(node.func) != "re.compile")
            or "typ='unsafe'" in call
            or (
                name == "load"
                and "np" in ast.unparse(node.func)
                and "allow_pickle=False" not in call
            )
            or "shell=True" in call
        )
        found += [call] if wrong else []
    return found


def test_dangers_are_seen() -> None:
    for source in (
        "import pickle",
        "from joblib import load",
        "eval(x)",
        "builtins.exec(x)",
        "pd.read_pickle(x)",
        "YAML(typ='unsafe')",
        "np.load(x)",
        "np.load(x, allow_pickle=True)",
        "subprocess.run(x, shell=True)",
    ):
        assert len(dangers(source)) == 1, source
    harmless = (
        "re.compile(x); f.compile(); YAML(typ='safe').load(x); np.load(x, allow_pickle=False)"
    )
    assert dangers(harmless) == []


@pytest.mark.parametrize("path", sorted((ROOT / "neol").rglob("*.py")), ids=str)
def test_nothing_read_is_executed(path: Path) -> None:
    assert dangers(path.read_text(encoding="utf-8")) == []
