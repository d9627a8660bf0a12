"""The control that chooses a run: a record, and one of its seeds."""

from pathlib import Path
from typing import Any

import traitlets
from ipywidgets import Dropdown, HBox, Layout

from neol.analysis.catalogue import find_records
from neol.champions.player import Player
from neol.explore.runs import load_player, load_record


class RunChoice(HBox):  # type: ignore[misc]
    """Two lists, one below the other's choice; shown in several places it is one control."""

    value = traitlets.Tuple()
    """Path of the record and seed. It changes once, with both of them."""

    def __init__(self, results: Path, record: str, seed: int) -> None:
        """Begin with a record and a seed, or with the first there is."""
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
