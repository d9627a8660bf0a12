"""YAML files laid over each other, every value remembering where it came from."""

import re
from pathlib import Path
from typing import Any

import yaml

from neol.errors import UserError


class _Loader(yaml.SafeLoader):
    """YAML 1.2's plain scalars (`off` is a word, `1e-3` a number), and no key twice."""

    yaml_implicit_resolvers = {}  # noqa: RUF012  # filled below through PyYAML's own interface

    def construct_mapping(self, node: yaml.MappingNode, deep: bool = False) -> dict[Any, Any]:
        keys = [key for key, _ in node.value if isinstance(key, yaml.ScalarNode)]
        for index, key in enumerate(keys):
            if key.value in [earlier.value for earlier in keys[:index]]:
                raise yaml.constructor.ConstructorError(
                    None,
                    None,
                    f'key "{key.value}" stands here a second time',
                    key.start_mark,
                )
        return super().construct_mapping(node, deep)


for _kind, _pattern, _first in (
    ("null", r"null|~|", ["n", "~", ""]),
    ("bool", r"true|false", ["t", "f"]),
    ("int", r"[-+]?(0|[1-9][0-9]*)", list("-+0123456789")),
    (
        "float",
        r"[-+]?(\.[0-9]+|[0-9]+(\.[0-9]*)?)([eE][-+]?[0-9]+)?",
        list("-+.0123456789"),
    ),
):
    _Loader.add_implicit_resolver(
        f"tag:yaml.org,2002:{_kind}", re.compile(f"^(?:{_pattern})$"), _first
    )


class Overlay:
    """Nested dictionaries merged key by key; `values` is the result.

    Raises UserError, in one line, for what cannot be read.
    """

    def __init__(self) -> None:
        self.values: dict[str, Any] = {}
        self._sources: dict[tuple[str, ...], str] = {}
        self._options: dict[tuple[str, ...], str] = {}

    def add_file(self, path: Path) -> None:
        """Lay a YAML file over what is there."""
        name = f"{path.parent.name}/{path.name}"
        try:
            content = _parse(path.read_text(encoding="utf-8"), name)
        except (OSError, UnicodeDecodeError) as error:
            raise UserError(f"{name}: cannot be read ({error})") from None
        if not isinstance(content, dict):
            raise UserError(f"{name}: must be a mapping of keys to values")
        self._sources[()] = name  # whoever leaves a key out, the last file is the place to mend it
        self._merge(self.values, content, name, ())

    def add_override(self, override: str) -> None:
        """Lay one value over what is there, written like "neat.elitism=3" (--set)."""
        key, equals, value = override.partition("=")
        path = key.strip().split(".")
        if not (equals and all(path)):
            raise UserError(f'--set "{override}": write it as key=value, like neat.elitism=3')
        self.add(tuple(path), _parse(value, f"--set {override}"), "--set")

    def add_option(self, option: str, loc: tuple[str, ...], value: str) -> None:
        """Lay the value of a command line's option over what is there."""
        self.add(loc, _parse(value, f"{option} {value}"), option)
        self._options[loc] = option

    def source(self, loc: tuple[str, ...]) -> str:
        """Where the value at a path of keys came from: a file's name, --set or an option."""
        while loc and loc not in self._sources:
            loc = loc[:-1]
        return self._sources[loc]

    def place(self, loc: tuple[str, ...]) -> str:
        """What a user has to mend for the value at a path of keys: an option, or a source's key."""
        return self._options.get(loc) or f"{self.source(loc)}: {'.'.join(loc)}"

    def add(self, loc: tuple[str, ...], content: Any, source: str) -> None:
        """Lay a value over what is there."""
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


def _parse(text: str, name: str) -> Any:
    try:
        return yaml.load(text, Loader=_Loader)  # a SafeLoader
    except yaml.MarkedYAMLError as error:
        line = f", line {error.problem_mark.line + 1}" if error.problem_mark else ""
        raise UserError(f"{name}{line}: {error.problem}") from None
    except yaml.YAMLError as error:
        raise UserError(f"{name}: {str(error).splitlines()[0]}") from None
