"""Progress of a run: its lines and their frequency."""

import io
import time

import pytest
from rich.console import Console
from rich.panel import Panel

from neol.cli.progress import Display, Progress, duration
from neol.run.evolution import Generation


@pytest.fixture
def clock(monkeypatch: pytest.MonkeyPatch) -> list[float]:
    """The time in seconds, which a test sets."""
    now = [100.0]
    monkeypatch.setattr(time, "monotonic", lambda: now[0])
    return now


def generation(number: int, env_steps: int) -> Generation:
    return Generation(number, 200.0, 51.25, 1.0, 8, env_steps, 3, 2.0, 8.0, 2, 8, 0.0, 0)


def test_progress_lines(capsys: pytest.CaptureFixture[str], clock: list[float]) -> None:
    with Progress([3, 8], 4) as progress:
        progress(3, generation(1, 500))
        clock[0] += 1
        progress(3, generation(2, 2500))  # 1 s after the first: not shown
        clock[0] += 2
        progress(3, generation(3, 4500))  # nor this
        clock[0] += 1
        progress(3, generation(4, 5500))  # nor this
        clock[0] += 2
        progress(8, generation(1, 2000))
    assert capsys.readouterr().err.splitlines() == [
        "seed 3 (1 of 2)  generation 1/4  best 200.0  mean 51.2  species 3",
        "seed 8 (2 of 2)  generation 1/4  best 200.0  mean 51.2  species 3  "
        "1,000 steps/s  0:05 left",
    ]


def test_the_last_line_always_comes(capsys: pytest.CaptureFixture[str], clock: list[float]) -> None:
    with Progress([3], 5) as progress:
        progress(3, generation(1, 500))
        clock[0] += 2
        progress(3, generation(2, 900))
    _, last = capsys.readouterr().err.splitlines()
    assert last.endswith("generation 2/5  best 200.0  mean 51.2  species 3")


def test_compiling_is_left_out_of_the_time_left(
    capsys: pytest.CaptureFixture[str], clock: list[float]
) -> None:
    with Progress([3], 5) as progress:
        for number, seconds in enumerate((17, 26, 2), 1):
            clock[0] += seconds
            progress(3, generation(number, 400 * number))
    *_, last = capsys.readouterr().err.splitlines()
    assert last.endswith("generation 3/5  best 200.0  mean 51.2  species 3  200 steps/s  0:04 left")


def test_a_line_is_not_said_twice(capsys: pytest.CaptureFixture[str], clock: list[float]) -> None:
    with Display() as display:
        for line in ("one", "one", "two", "two"):
            clock[0] += 10
            display.show(line)
    assert capsys.readouterr().err.splitlines() == ["one", "two"]


def test_a_terminal_shows_the_picture_or_the_line() -> None:
    screen = io.StringIO()
    for picture in (Panel("a picture"), None):
        with Display(Console(file=screen, force_terminal=True, width=40)) as display:
            display.show("a line [of text]", picture)
    assert screen.getvalue().count("a picture") == 1
    assert screen.getvalue().count("a line [of text]") == 1


def test_durations() -> None:
    assert [duration(s) for s in (0, 59.6, 3599, 3600)] == ["0:00", "1:00", "59:59", "1:00:00"]
