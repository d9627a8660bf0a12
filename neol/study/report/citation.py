"""What this is, who made it and which paper it reproduces: CITATION.cff."""

from typing import Any

from neol.spec.configuration import ROOT
from neol.spec.plain_yaml import read_yaml

CITATION = ROOT / "CITATION.cff"


def citation() -> dict[str, Any]:
    """The fields of the Citation File Format; its first reference is the paper."""
    content: dict[str, Any] = read_yaml(CITATION, CITATION.name)
    return content
