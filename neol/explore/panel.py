"""A panel of a notebook: controls, and below them the picture that they make.

The picture is an ordinary output, replaced in place, so that an executed copy shows the default
one wherever it is read.
"""

import base64
import html
from collections.abc import Callable, Iterator
from typing import Any

from IPython.display import HTML, Image, display
from ipywidgets import Button, VBox
from matplotlib.figure import Figure

from neol.analysis.style import png
from neol.champions.film import Film
from neol.errors import UserError


class Panel:
    """Draws when it is shown, and again when a control changes or, with a button, when asked to.

    `draw` gets the value of each control by its name. It returns what a notebook can show, a figure
    or a film, or yields several, each in place of the one before. A UserError is shown as its line.
    """

    def __init__(self, draw: Callable[..., object], button: str = "", **controls: Any) -> None:
        self.controls = controls
        self.button = Button(description=button)
        self.picture: object = None
        """What is shown."""
        self._draw = draw
        self._asks = bool(button)
        self._handle: Any = None

    def _ipython_display_(self) -> None:
        display(VBox([*self.controls.values(), *([self.button] if self._asks else [])]))
        self._handle = display(HTML("drawing ..."), display_id=True)
        self._redraw()
        if self._asks:
            self.button.on_click(self._redraw)
        else:
            for control in self.controls.values():
                control.observe(self._redraw, "value")

    def _redraw(self, _event: object = None) -> None:
        for picture in self._pictures():
            self.picture = picture
            self._handle.update(_displayable(picture))

    def _pictures(self) -> Iterator[object]:
        try:
            drawn = self._draw(**{name: each.value for name, each in self.controls.items()})
            yield from drawn if isinstance(drawn, Iterator) else (drawn,)
        except UserError as error:
            yield HTML(f"<pre>neol: {html.escape(str(error))}</pre>")


def _displayable(picture: object) -> object:
    """What IPython shows alike everywhere: a figure as PNG, a film within HTML."""
    if isinstance(picture, Figure):
        return Image(png(picture))
    if isinstance(picture, Film):
        content = base64.b64encode(picture.gif).decode()
        return HTML(f'<img alt="a filmed episode" src="data:image/gif;base64,{content}">')
    return picture
