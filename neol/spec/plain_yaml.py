"""YAML 1.2 from untrusted files: plain values only, in the amount that a configuration needs."""

import re
from functools import lru_cache
from pathlib import Path
from typing import Any

from ruamel.yaml import YAML
from ruamel.yaml.constructor import ConstructorError, SafeConstructor
from ruamel.yaml.error import MarkedYAMLError, YAMLError
from ruamel.yaml.nodes import MappingNode, Node, ScalarNode, SequenceNode

from neol.base.errors import UserError
from neol.base.files import read_bounded

MAX_BYTES = 2**18
MAX_VALUES = 2**15
"""Limit with every alias expanded: a few lines of nested aliases could stand for billions."""
PLAIN = {f"tag:yaml.org,2002:{k}" for k in ("null", "bool", "int", "float", "str", "seq", "map")}
"""Types of JSON: no dates, sets, bytes or merged mappings."""
SURROGATE = re.compile(r"[\ud800-\udfff]")
"""Half a character of UTF-16, which an escape can write and JSON cannot hold."""


class _PlainConstructor(SafeConstructor):
    """Constructor that checks all values before it makes any."""

    def construct_document(self, node: Node) -> Any:
        waiting, seen = [node], 0
        while waiting:
            each = waiting.pop()
            seen += 1
            if each.tag not in PLAIN:
                _refuse(f"{each.tag} is not a plain value", each)
            if isinstance(each, ScalarNode) and SURROGATE.search(each.value):
                _refuse("not a character of Unicode", each)
            if isinstance(each, SequenceNode):
                waiting += each.value
            elif isinstance(each, MappingNode):
                for key, value in each.value:
                    if not isinstance(key, ScalarNode):
                        _refuse("a key is not a plain value", key)
                    waiting += key, value
            if seen + len(waiting) > MAX_VALUES:
                _refuse(f"more than {MAX_VALUES} values", node)
        return super().construct_document(node)


def _refuse(problem: str, node: Node) -> None:
    raise ConstructorError(None, None, problem, node.start_mark)


def read_yaml(path: Path, name: str) -> Any:
    """Return the content of a YAML file: None, bool, int, float, str, lists and dictionaries.

    Raises UserError, one line that begins with `name`, for anything else.
    """
    try:
        text = read_bounded(path, MAX_BYTES).decode("utf-8")
    except UnicodeDecodeError as error:
        raise UserError(f"{name}: cannot be read ({error})") from None
    return parse_yaml(text, name)


@lru_cache(maxsize=64)  # a study overlays the same files with each variant's constants
def parse_yaml(text: str, name: str) -> Any:
    """Return the content of a YAML text. It is cached and shared: callers must not change it."""
    yaml = YAML(typ="safe", pure=True)  # not libyaml, which reads YAML 1.1
    yaml.Constructor = _PlainConstructor
    try:
        return yaml.load(text)
    except MarkedYAMLError as error:
        line = f", line {error.problem_mark.line + 1}" if error.problem_mark else ""
        problem, _, _ = error.problem.partition(" with value ")  # the value may be long
        raise UserError(f"{name}{line}: {problem}") from None
    except YAMLError as error:
        raise UserError(f"{name}: {str(error).splitlines()[0]}") from None
    except RecursionError:
        raise UserError(f"{name}: nested too deeply") from None
    except (ValueError, LookupError, OverflowError) as error:  # !!int one, !!int "", "\UFFFFFFFF"
        raise UserError(f"{name}: not a value of its kind ({error})") from None
