"""CITATION.cff and pyproject.toml say the same of the project."""

import importlib.metadata
import tomllib

from neol.spec.configuration import ROOT
from neol.study.report.citation import citation


def test_the_citation_agrees_with_pyproject() -> None:
    cited = citation()
    project = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["project"]
    assert cited["abstract"] == project["description"]
    assert cited["authors"] == project["authors"]
    for key in ("version", "license", "keywords"):
        assert cited[key] == project[key]
    assert importlib.metadata.version("neol") == project["version"]
    (paper,) = cited["references"]
    assert paper["title"] in (ROOT / "README.md").read_text(encoding="utf-8")
