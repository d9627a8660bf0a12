"""Fixtures that several tests share, and the order of tests."""

import signal
from pathlib import Path

import pytest

# Under nohup it is ignored, and tests that send it would wait for ever.
signal.signal(signal.SIGHUP, signal.SIG_DFL)


def pytest_collection_modifyitems(items: list[pytest.Item]) -> None:
    """Run whole workflows first: they take longest, while another process runs other tests."""
    items.sort(key=lambda item: item.path.parent.name not in ("workflow", "cluster"))


@pytest.fixture
def own_folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Run a test in an empty folder."""
    monkeypatch.chdir(tmp_path)
