"""What this is, who made it and which paper it reproduces: said once, in pyproject.toml.

`python -m neol.study.report.metadata` writes CITATION.cff from it; report and paper read it.
"""

import tomllib
from pathlib import Path
from typing import Any

import yaml

from neol.base.files import write_atomically
from neol.spec.configuration import ROOT
from neol.spec.types import Model

CITATION = ROOT / "CITATION.cff"


class Paper(Model):
    """The paper that is reproduced."""

    title: str
    authors: list[str]


class ProjectMetadata(Model):
    """The project, as others should name it."""

    title: str
    description: str
    version: str
    license: str
    """SPDX identifier."""
    authors: list[str]
    keywords: list[str]
    paper: Paper


def metadata(root: Path = ROOT) -> ProjectMetadata:
    """What a checkout's pyproject.toml says."""
    content = tomllib.loads((root / "pyproject.toml").read_text(encoding="utf-8"))
    project = content["project"]
    return ProjectMetadata(
        **{key: project[key] for key in ("description", "version", "license", "keywords")},
        authors=[author["name"] for author in project["authors"]],
        **content["tool"]["neol"],
    )


def citation(project: ProjectMetadata) -> str:
    """The content of CITATION.cff (Citation File Format 1.2.0)."""
    content: dict[str, Any] = {
        "cff-version": "1.2.0",
        "message": "If you use this software, please cite it, and the paper that it reproduces.",
        "type": "software",
        "title": project.title,
        "abstract": project.description,
        "authors": [{"name": author} for author in project.authors],
        "version": project.version,
        "license": project.license,
        "keywords": project.keywords,
        "references": [
            {
                "type": "article",
                "title": project.paper.title,
                "authors": [{"name": author} for author in project.paper.authors],
                "notes": "The paper that this software reproduces.",
            }
        ],
    }
    header = "# Written by `python -m neol.study.report.metadata` from pyproject.toml.\n"
    return header + yaml.safe_dump(content, sort_keys=False, width=100)


if __name__ == "__main__":
    write_atomically(CITATION, citation(metadata()).encode())
