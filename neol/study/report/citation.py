"""The project, its authors and the paper that it reproduces: CITATION.cff."""

from typing import Any

from neol.spec.configuration import ROOT
from neol.spec.plain_yaml import read_yaml

CITATION = ROOT / "CITATION.cff"


def citation() -> dict[str, Any]:
    """Return the fields of the Citation File Format; the first reference is the paper."""
    content: dict[str, Any] = read_yaml(CITATION, CITATION.name)
    return content
