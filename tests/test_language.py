"""The project's prose avoids words and openings that a reader has to decode."""

import io
import json
import re
import tokenize
from collections.abc import Callable, Iterator
from pathlib import Path

import pytest

from neol.spec.configuration import ROOT

BANNED = {
    r"(told|tells?|telling)( \w+){0,3} apart": "distinguishable, distinguish",
    r"(came|comes?|coming) to": "is, gives, reaches, a result",
    r"anew": "again",
    r"mend(s|ed|ing)?": "fix",
    r"vouch\w*": "verify",
    r"whatever": "any, or name what it is",
    r"oftener": "more often",
    r"what is told": "what is reported",
    r"hangs? on": "depends on, the weakest part",
    r"(bears?|bore|borne) out": "support",
    r"besides": "also",
    r"(speaks?|spoke|speaking) of": "name, mention",
    r"(has|have) to itself": "has alone",
    r"this host's own": "of this host",
}
"""Patterns of words, and what to write instead."""
FRAGMENT = re.compile(r'^ *"""(?:Of|As|That|Those|Such) .*', re.MULTILINE)
"""First line of a docstring, of code or data, whose first word does not stand alone."""

PYTHON = "neol/**/*.py", "tests/**/*.py", "benchmarks/**/*.py"
TEXT = (
    *("config/**/*.yaml", "profiles/**/*.yaml", "rules/*.smk", "Snakefile", "Makefile"),
    *("README.md", "CONTRIBUTING.md", "CHANGELOG.md", "docs/*.md", "docs/*/*.md"),
    *("neol/**/*.?pp", "neol/**/*.j2", "paper/*.tex", "paper/plan.md"),
)
NOTEBOOKS = ("notebooks/*.ipynb",)
LEFT_OUT = {
    "tests/test_language.py": "lists the words",
    "docs/readings-plan.md": "frozen before the runs",
}
"""Files and folders that are not searched, and why."""


def _files(*patterns: str) -> list[Path]:
    found = (path for pattern in patterns for path in sorted(ROOT.glob(pattern)))
    return [path for path in found if not any(_is_below(path, place) for place in LEFT_OUT)]


def _is_below(path: Path, place: str) -> bool:
    return path.is_relative_to(ROOT / place)


def _prose(path: Path) -> str:
    """Return the text of a file that people read, line by line where the file has it."""
    text = path.read_text(encoding="utf-8")
    if path.suffix == ".ipynb":
        cells = json.loads(text)["cells"]
        return "\n".join("".join(c["source"]) for c in cells if c["cell_type"] == "markdown")
    if path.suffix != ".py" or not any(banned_words(text)):
        return text  # without a search for strings and comments, which takes long
    lines = [""] * (text.count("\n") + 2)
    for token in tokenize.generate_tokens(io.StringIO(text).readline):
        kind = tokenize.tok_name[token.type]
        if kind in ("COMMENT", "STRING", "FSTRING_MIDDLE"):
            for number, line in enumerate(token.string.splitlines(), token.start[0]):
                lines[number] += f" {line}"
    return "\n".join(lines[1:])


def _report(files: list[Path], find: Callable[[Path], Iterator[str]]) -> str:
    return "\n".join(f"{path.relative_to(ROOT)}: {each}" for path in files for each in find(path))


def banned_words(prose: str) -> Iterator[str]:
    """Yield each banned word with its line and what to write instead."""
    for pattern, instead in BANNED.items():
        for match in re.finditer(rf"\b{pattern}\b".replace(" ", r"\s+"), prose, re.IGNORECASE):
            line = prose.count("\n", 0, match.start()) + 1
            yield f"line {line}: {match.group()!r} (write: {instead})"


def fragments(source: str) -> Iterator[str]:
    """Yield each docstring whose first word needs the words around it."""
    for match in FRAGMENT.finditer(source):
        line = source.count("\n", 0, match.start()) + 1
        yield f"line {line}: {match.group().strip()} (begin with a verb or noun)"


@pytest.mark.parametrize("patterns", [PYTHON, TEXT, NOTEBOOKS])
def test_no_banned_words(patterns: tuple[str, ...]) -> None:
    files = _files(*patterns)
    assert files
    assert _report(files, lambda path: banned_words(_prose(path))) == ""


def test_no_docstring_begins_with_a_fragment() -> None:
    assert _report(_files(*PYTHON), lambda path: fragments(path.read_text(encoding="utf-8"))) == ""


def test_what_is_left_out_exists() -> None:
    assert [place for place in LEFT_OUT if not (ROOT / place).exists()] == []


def test_banned_words_are_found() -> None:
    prose = "The run is made anew.\nTwo methods are told\napart. It depends on commends."
    assert [each.partition(" (")[0] for each in banned_words(prose)] == [
        "line 2: 'told\\napart'",
        "line 1: 'anew'",
    ]
    assert list(fragments('x = 1\n"""Of the trajectory."""\ny = 2\n"""Offspring."""'))
