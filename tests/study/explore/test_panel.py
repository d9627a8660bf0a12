"""Panels: a change of a control is a new picture in the old one's place."""

from collections.abc import Iterator
from typing import Any

import pytest
from ipywidgets import IntSlider
from matplotlib.figure import Figure

from neol.base.errors import UserError
from neol.pictures.film import Film
from neol.study.explore import panel as module
from neol.study.explore.panel import Panel


class Output:
    """Where a notebook would show things: a place that is written over."""

    def __init__(self, monkeypatch: pytest.MonkeyPatch) -> None:
        self.first: list[object] = []
        self.updates: list[Any] = []
        monkeypatch.setattr(module, "display", self._display)

    def update(self, shown: object) -> None:
        self.updates.append(shown)

    def _display(self, shown: object, display_id: bool = False) -> object:
        self.first.append(shown)
        return self if display_id else None


@pytest.fixture
def output(monkeypatch: pytest.MonkeyPatch) -> Output:
    return Output(monkeypatch)


def test_a_changed_control_draws_anew(output: Output) -> None:
    panel = Panel(lambda a, b: f"{a} and {b}", a=IntSlider(1), b=IntSlider(2))
    panel._ipython_display_()
    assert output.first[0].children == tuple(panel.controls.values())  # type: ignore[attr-defined]
    panel.controls["b"].value = 7
    assert output.updates == ["1 and 2", "1 and 7"]
    assert panel.picture == "1 and 7"


def test_a_button_waits_to_be_asked(output: Output) -> None:
    panel = Panel(lambda a: str(a), button="Go", a=IntSlider(1))
    panel._ipython_display_()
    panel.controls["a"].value = 5
    assert output.updates == ["1"]
    panel.button.click()
    assert output.updates == ["1", "5"]


def test_pictures_that_follow_each_other(output: Output) -> None:
    def count(to: int) -> Iterator[str]:
        yield from map(str, range(to))

    Panel(count, to=IntSlider(3))._ipython_display_()
    assert output.updates == ["0", "1", "2"]


@pytest.mark.parametrize("late", [False, True])
def test_a_users_error_is_a_line(output: Output, late: bool) -> None:
    def refuse(a: int) -> Iterator[str]:
        if late:
            yield "drawn"
        raise UserError(f"a = {a}: <must> be 2")

    Panel(refuse, a=IntSlider(1))._ipython_display_()
    assert output.updates[-1].data == "<pre>neol: a = 1: &lt;must&gt; be 2</pre>"
    assert len(output.updates) == 1 + late


def test_figures_and_films_are_shown_alike_everywhere(output: Output) -> None:
    drawn = [Figure(), Film(b"GIF89a", trace=None, frames=1)]  # type: ignore[arg-type]
    Panel(lambda: iter(drawn))._ipython_display_()
    figure, film = output.updates
    assert figure.data.startswith(b"\x89PNG")
    assert b"Matplotlib" not in figure.data  # no version, as in no file
    assert 'src="data:image/gif;base64,R0lGODlh"' in film.data
