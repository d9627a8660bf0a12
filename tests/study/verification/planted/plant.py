"""What an error is."""

from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path


@dataclass(frozen=True)
class Plant:
    """An error, and what has to find it."""

    kind: str
    """What was done, for the table."""
    do: Callable[[Path], object]
    options: str = ""
    """Options of `neol verify` that find it; without them it must go unnoticed."""
