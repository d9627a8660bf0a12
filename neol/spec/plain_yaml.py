"""YAML from anyone: plain values only, and no more of them than a configuration needs."""

import re
from functools import lru_cache
from pathlib import Path
from typing import Any

import yaml

from neol.base.errors import UserError
from neol.base.files import read_bounded

MAX_BYTES = 2**18
MAX_VALUES = 2**15
"""With every alias written out: a few lines of aliases to aliases could stand for billions."""


class _Loader(yaml.SafeLoader):
    """YAML 1.2's plain scalars (`off` is a word, `1e-3` a number), and no key twice."""

    yaml_implicit_resolvers = {}  # noqa: RUF012  # filled below through PyYAML's own interface

    def construct_document(self, node: yaml.Node) -> Any:
        waiting, seen = [node], 0
        while waiting:
            each = waiting.pop()
            seen += 1
            if isinstance(each, yaml.SequenceNode):
                waiting += each.value
            elif isinstance(each, yaml.MappingNode):
                waiting += [part for pair in each.value for part in pair]
            if seen + len(waiting) > MAX_VALUES:
                problem = f"more than {MAX_VALUES} values"
                raise yaml.constructor.ConstructorError(None, None, problem, node.start_mark)
        return super().construct_document(node)

    def construct_mapping(self, node: yaml.MappingNode, deep: bool = False) -> dict[Any, Any]:
        keys: set[str] = set()
        for key, _ in node.value:
            if not isinstance(key, yaml.ScalarNode):
                continue
            if key.value in keys:
                problem = f'key "{key.value}" stands here a second time'
                raise yaml.constructor.ConstructorError(None, None, problem, key.start_mark)
            keys.add(key.value)
        return super().construct_mapping(node, deep)


_Loader.yaml_constructors = {  # no dates, sets or bytes: what JSON has
    tag: yaml.SafeLoader.yaml_constructors[tag]
    for tag in (
        *(f"tag:yaml.org,2002:{kind}" for kind in ("null", "bool", "int", "float", "str")),
        *(f"tag:yaml.org,2002:{kind}" for kind in ("seq", "map")),
        None,
    )
}
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


def read_yaml(path: Path, name: str) -> Any:
    """The content of a YAML file: None, bool, int, float, str, lists and dictionaries of them.

    Raises UserError, one line that begins with `name`, for anything else.
    """
    try:
        text = read_bounded(path, MAX_BYTES).decode("utf-8")
    except UnicodeDecodeError as error:
        raise UserError(f"{name}: cannot be read ({error})") from None
    return parse_yaml(text, name)


@lru_cache(maxsize=64)  # a study lays each variant's few constants over the same files
def parse_yaml(text: str, name: str) -> Any:
    """The same of a text. Whoever asks again gets the same object: it is not to be changed."""
    try:
        return yaml.load(text, Loader=_Loader)  # a SafeLoader
    except yaml.MarkedYAMLError as error:
        line = f", line {error.problem_mark.line + 1}" if error.problem_mark else ""
        raise UserError(f"{name}{line}: {error.problem}") from None
    except yaml.YAMLError as error:
        raise UserError(f"{name}: {str(error).splitlines()[0]}") from None
    except RecursionError:
        raise UserError(f"{name}: nested too deeply") from None
    except (ValueError, KeyError) as error:  # !!int one, a number of thousands of digits
        raise UserError(f"{name}: not a value of its kind ({error})") from None
