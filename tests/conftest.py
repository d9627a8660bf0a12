"""What all tests share."""

import pytest

LONG = ("cluster", "workflow", "report", "explore")
"""Folders of the files that take minutes, the longest first."""


def pytest_collection_modifyitems(items: list[pytest.Item]) -> None:
    """Begin with the long files, so that two workers end together: they share files, not tests."""
    items.sort(key=lambda item: (*LONG, item.path.parent.name).index(item.path.parent.name))
