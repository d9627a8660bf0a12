"""Fixtures that several tests share, and the order of tests."""

import signal
from pathlib import Path

import pytest

# Under nohup it is ignored, and tests that send it would wait for ever.
signal.signal(signal.SIGHUP, signal.SIG_DFL)

LONGEST = {"workflow", "cluster", "test_how_to"}
"""Folders and files that run whole workflows."""


def pytest_collection_modifyitems(items: list[pytest.Item]) -> None:
    """Run the longest files first, so that no process has one left when the other has finished."""
    items.sort(key=lambda item: not LONGEST & {item.path.parent.name, item.path.stem})


@pytest.fixture
def own_folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Run a test in an empty folder."""
    monkeypatch.chdir(tmp_path)
