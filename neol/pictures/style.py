"""Style of all pictures: one colour, line and marker for each method, and reproducible files.

The hues are the paper's (BCM blue, Hebb orange, Oja green, NEAT red) in the tints of Okabe and Ito,
which remain distinguishable with colour blindness, as lines and markers do in grey print.
NEAT (w/o), which the paper draws red too, is purple, so that each method has one colour in all
figures. Other methods of a budget take the rest of the palette.
"""

import io
import textwrap
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import matplotlib as mpl
from matplotlib.figure import Figure

from neol.base.errors import UserError
from neol.base.files import write_atomically

WIDTH = 7.2
"""Text width of a page in inches."""
SCREEN_DPI = 110
GREY = "0.35"
COLOUR_MAP = mpl.colormaps["cividis"]


@dataclass(frozen=True, slots=True)
class Style:
    """Colour, line and marker of a method."""

    colour: str
    line: Any
    marker: str


STYLES = {
    "bcm": Style("#0072B2", "-", "o"),
    "hebb": Style("#E69F00", (0, (5, 1.5)), "s"),
    "oja": Style("#009E73", (0, (5, 1.5, 1, 1.5)), "^"),
    "neat": Style("#D55E00", (0, (1.2, 1.2)), "D"),
    "neat_wo": Style("#7F4F9B", (0, (3, 1.2, 1, 1.2, 1, 1.2)), "v"),
}

_FURTHER_COLOURS = ("#56B4E9", "#CC79A7", "#222222", "#8C6D1F")
_FURTHER_MARKERS = ("P", "X", "*", "<", ">")
_FURTHER_LINES = ((0, (8, 1.5)), (0, (8, 1.5, 1, 1.5)), (0, (2.5, 1)))

RC_PARAMS: dict[Any, Any] = {
    "font.size": 8,
    "axes.titlesize": 8.5,
    "figure.titlesize": 9,
    "axes.labelsize": 8,
    "xtick.labelsize": 7,
    "ytick.labelsize": 7,
    "legend.fontsize": 7.5,
    "legend.frameon": False,
    "axes.spines.top": False,
    "axes.spines.right": False,
    "axes.linewidth": 0.7,
    "lines.linewidth": 1.3,
    "lines.markersize": 3.5,
    "hatch.linewidth": 0.5,
    "figure.constrained_layout.use": True,
    "figure.constrained_layout.hspace": 0.0,
    "pdf.fonttype": 42,
    "svg.hashsalt": "neol",
    "savefig.dpi": 200,
}
_METADATA: dict[str, Any] = {
    "pdf": {"CreationDate": None, "Creator": None, "Producer": None},
    "png": {"Software": None},
    "svg": {"Date": None, "Creator": None},
}
"""Metadata of a picture's file by kind; without date and version, so that files repeat."""


def styles(methods: Sequence[str]) -> dict[str, Style]:
    """Return the style of each method of a budget.

    Methods that the paper lacks get styles in their order; the first 60 of these are distinct.
    """
    further = [method for method in methods if method not in STYLES]
    chosen = {
        method: Style(
            _FURTHER_COLOURS[place % len(_FURTHER_COLOURS)],
            _FURTHER_LINES[place % len(_FURTHER_LINES)],
            _FURTHER_MARKERS[place % len(_FURTHER_MARKERS)],
        )
        for place, method in enumerate(further)
    }
    return {method: STYLES.get(method) or chosen[method] for method in methods}


@contextmanager
def drawing() -> Iterator[None]:
    """Draw with exactly these Matplotlib settings and none of the user's."""
    with mpl.rc_context():
        mpl.rcdefaults()
        mpl.rcParams.update(RC_PARAMS)
        yield


def footer(figure: Figure, text: str) -> None:
    """Write a line or two below a figure: the budget, and what is missing."""
    characters = int(figure.get_figwidth() * 19)
    lines = [line for part in text.splitlines() for line in textwrap.wrap(part, characters)]
    figure.supxlabel("\n".join(lines), x=0.01, ha="left", fontsize=7, color=GREY)


def save(figure: Figure, path: Path) -> list[Path]:
    """Write path.pdf and path.png (see `write_picture`); return both paths."""
    path.parent.mkdir(parents=True, exist_ok=True)
    outputs = [path.with_suffix(f".{kind}") for kind in ("pdf", "png")]
    for output in outputs:
        write_picture(figure, output)
    return outputs


def write_picture(figure: Figure, path: Path) -> None:
    """Write a figure in the format of the path's suffix: .pdf, .png or .svg."""
    write_atomically(path, rendered(figure, picture_kind(path)))


def png(figure: Figure) -> bytes:
    """Return a figure as PNG for a notebook."""
    return rendered(figure, "png", SCREEN_DPI)


def rendered(figure: Figure, kind: str, dpi: int | None = None) -> bytes:
    """Return a figure as the content of a file: pdf, png or svg.

    Equal pictures give equal bytes: the file holds neither date nor version.
    """
    buffer = io.BytesIO()
    with drawing():
        figure.savefig(buffer, format=kind, dpi=dpi, metadata=_METADATA[kind])
    return buffer.getvalue()


def picture_kind(path: Path) -> str:
    """Return the kind of a picture's file: pdf, png or svg. Raises UserError for other suffixes."""
    kind = path.suffix.removeprefix(".").lower()
    if kind not in _METADATA:
        raise UserError(f"{path}: pictures are {', '.join(_METADATA)}; end its name in one of them")
    return kind
