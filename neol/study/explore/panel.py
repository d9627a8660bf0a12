"""A panel of a notebook: controls, and below them the picture that they make.

The picture is an ordinary output, replaced in place, so an executed copy shows the default picture
in any viewer.
"""

import base64
import html
from collections.abc import Callable, Iterator
from functools import lru_cache
from pathlib import Path
from typing import Any

import traitlets
from IPython.display import HTML, Image, display
from ipywidgets import Button, Dropdown, HBox, Layout, VBox
from matplotlib.figure import Figure

from neol.base.errors import UserError
from neol.champions.player import Player, load_champion
from neol.pictures.film import Film
from neol.pictures.style import png
from neol.run.catalogue import find_records
from neol.run.record import Record
from neol.run.record_file import read_record


class Panel:
    """Panel that draws when shown, and again when a control changes or its button is pressed.

    `draw` gets the value of each control by its name. It returns a figure, a film or another
    output, or yields several, each of which replaces the last. A UserError is shown as its line.
    """

    def __init__(self, draw: Callable[..., object], button: str = "", **controls: Any) -> None:
        self.controls = controls
        self.button = Button(description=button)
        self.picture: object = None
        """The widgets that are shown."""
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
    """Convert to an output that all viewers show alike: a figure to PNG, a film to HTML."""
    if isinstance(picture, Figure):
        return Image(png(picture))
    if isinstance(picture, Film):
        content = base64.b64encode(picture.gif).decode()
        return HTML(f'<img alt="a filmed episode" src="data:image/gif;base64,{content}">')
    return picture


class RunChoice(HBox):  # type: ignore[misc]
    """Choice of a record and one of its seeds; one control even if shown in several places."""

    value = traitlets.Tuple()
    """Path of the record, and seed; both change in one event."""

    def __init__(self, results: Path, record: str, seed: int) -> None:
        """Begin with a record and a seed, or with the first available ones."""
        self._results = results
        found = find_records(results)
        self.record = Dropdown(
            options=found,
            value=record if record in found else found[0],
            description="record",
            layout=Layout(width="44em"),
        )
        self.seed = Dropdown(description="seed", layout=Layout(width="12em"))
        super().__init__([self.record, self.seed])
        self.record.observe(self._offer_seeds, "value")
        self.seed.observe(self._choose, "value")
        self._offer_seeds()
        if seed in self.seed.options:
            self.seed.value = seed

    @property
    def player(self) -> Player:
        """The champion of the chosen run."""
        return load_player(*self.value)

    def _offer_seeds(self, _change: Any = None) -> None:
        record = load_record(self._results / self.record.value)
        self.seed.options = [info.seed for info in record.seeds]
        self.seed.value = self.seed.options[0]
        self._choose()

    def _choose(self, _change: Any = None) -> None:
        self.value = (self._results / self.record.value, self.seed.value)


@lru_cache(maxsize=64)
def load_record(path: Path) -> Record:
    """Read and verify a record; the latest ones are cached. Raises UserError."""
    return read_record(path)


@lru_cache(maxsize=16)
def load_player(path: Path, seed: int) -> Player:
    """Load the champion of a run, once. Raises UserError."""
    return load_champion(path, seed)


def episode_seed(player: Player, episode: int) -> int:
    """Return the seed of a held-out episode of a player. Raises UserError beyond the last one."""
    seeds = player.held_out_seeds
    if not 0 <= episode < len(seeds):
        raise UserError(f"episode {episode}: the record has 0 to {len(seeds) - 1}")
    return seeds[episode]
