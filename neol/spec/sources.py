"""YAML files laid over each other; every value remembers its source."""

import json
from collections.abc import Mapping
from pathlib import Path
from typing import Any, TypeVar

from pydantic import TypeAdapter, ValidationError

from neol.base.errors import UserError, one_line
from neol.spec.plain_yaml import parse_yaml, read_yaml

T = TypeVar("T")

DEEPEST = 10
"""Limit of the keys in a path; those of the configuration are shorter."""


def by_dotted_key(content: Mapping[str, Any], prefix: str = "") -> dict[str, Any]:
    """Nested values in one dictionary, by paths of keys such as neat.elitism."""
    flat = dict[str, Any]()
    for key, value in content.items():
        inner = isinstance(value, Mapping)
        flat |= by_dotted_key(value, f"{prefix}{key}.") if inner else {f"{prefix}{key}": value}
    return flat


class Overlay:
    """Nested dictionaries merged key by key; `values` is the result.

    Raises UserError (one line) for input that cannot be read.
    """

    def __init__(self) -> None:
        self.values: dict[str, Any] = {}
        self._sources: dict[tuple[str, ...], str] = {}
        self._options: dict[tuple[str, ...], str] = {}

    @classmethod
    def of(cls, path: Path) -> "Overlay":
        """Return an overlay of a single file."""
        overlay = cls()
        overlay.add_file(path)
        return overlay

    def add_file(self, path: Path) -> None:
        """Lay a YAML file over the present values."""
        name = str(Path(*path.parts[-2:]))  # config/base.yaml
        content = read_yaml(path, name)
        if not isinstance(content, dict):
            raise UserError(f"{name}: must be a mapping of keys to values")
        self._sources[()] = name  # a missing key is to be added in the last file
        self._merge(self.values, content, name, ())

    def add_override(self, override: str, source: str = "--set") -> None:
        """Lay one value over the present ones, written like "neat.elitism=3"."""
        key, equals, value = override.partition("=")
        path = key.strip().split(".")
        if not (equals and all(path) and len(path) <= DEEPEST):
            raise UserError(f'{source} "{override}": write it as key=value, like neat.elitism=3')
        self.add(tuple(path), parse_yaml(value, f"{source} {override}"), source)

    def add_option(self, option: str, loc: tuple[str, ...], value: str) -> None:
        """Lay the value of a command-line option over the present values."""
        self.add(loc, parse_yaml(value, f"{option} {value}"), option)
        self._options[loc] = option

    def source(self, loc: tuple[str, ...]) -> str:
        """Return the source of the value at a path of keys: a file's name, --set or an option."""
        while loc and loc not in self._sources:
            loc = loc[:-1]
        return self._sources[loc]

    def place(self, loc: tuple[str, ...]) -> str:
        """Return what the user must fix for the value at a path of keys: an option or a key."""
        return self._options.get(loc) or f"{self.source(loc)}: {'.'.join(loc)}"

    def parse(self, kind: type[T]) -> T:
        """Return the values as a typed value. Raises UserError for one that is not allowed."""
        try:
            return TypeAdapter(kind).validate_json(json.dumps(self.values))
        except ValidationError as error:
            raise UserError(one_line(error, kind, self.place)) from None

    def add(self, loc: tuple[str, ...], content: Any, source: str) -> None:
        """Lay a value over the present ones."""
        for key in reversed(loc):
            content = {key: content}
        self._merge(self.values, content, source, ())

    def _merge(
        self,
        below: dict[str, Any],
        above: dict[str, Any],
        source: str,
        loc: tuple[str, ...],
    ) -> None:
        for key, value in above.items():
            here = (*loc, str(key))
            self._sources[here] = source
            if isinstance(value, dict):
                if not isinstance(below.get(here[-1]), dict):
                    below[here[-1]] = {}
                self._merge(below[here[-1]], value, source, here)
            else:
                below[here[-1]] = value
