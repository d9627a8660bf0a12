"""A drawn figure and its sources, and the styles that all figures share."""

from dataclasses import dataclass
from pathlib import Path

import pandas as pd
from matplotlib.figure import Figure

from neol.base.files import write_atomically
from neol.pictures.style import Style, png, save, styles
from neol.spec.configuration import Configuration
from neol.spec.constants import Budget
from neol.study.campaign.methods import shown_methods
from neol.study.outcomes.campaign_runs import Source
from neol.study.output.sidecar import write_sidecar


@dataclass(frozen=True, repr=False)
class Drawing:
    """A figure with its name and sources. A notebook shows it as a picture."""

    name: str
    """Stem of its files: figure2."""
    figure: Figure
    configuration: Configuration
    sources: tuple[Source, ...]
    """The records behind it."""
    frame: pd.DataFrame | None = None
    """Numbers that it shows, if no table holds them."""

    def write(self, folder: Path) -> None:
        """Write name.pdf, name.png, name.json (where it comes from) and, with a frame, name.csv."""
        outputs = save(self.figure, folder / f"{self.name}.pdf")
        if self.frame is not None:
            outputs.append(folder / f"{self.name}.csv")
            write_atomically(outputs[-1], self.frame.to_csv(index=False).encode())
        write_sidecar(outputs, self.configuration, self.sources)

    def _repr_png_(self) -> bytes:
        return png(self.figure)


def looks_of(table: pd.DataFrame, budget: Budget) -> dict[str, Style]:
    """Return the styles of a table's methods, in the order that all figures share."""
    there = set(table["method"])
    looks = styles(shown_methods(budget))
    return {method: style for method, style in looks.items() if method in there}
