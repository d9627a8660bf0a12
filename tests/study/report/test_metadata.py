"""One source of metadata: what is derived from pyproject.toml agrees with it."""

import importlib.metadata

from neol.study.report.metadata import CITATION, citation, metadata


def test_citation_file_is_the_one_that_pyproject_makes() -> None:
    assert CITATION.read_text(encoding="utf-8") == citation(metadata()), (
        "run `python -m neol.study.report.metadata`"
    )


def test_installed_version_is_that_of_pyproject() -> None:
    assert importlib.metadata.version("neol") == metadata().version
