"""YAML 1.2 from anyone: plain values only, and no more of them than a configuration needs."""

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
"""With every alias written out: a few lines of aliases to aliases could stand for billions."""
PLAIN = {f"tag:yaml.org,2002:{k}" for k in ("null", "bool", "int", "float", "str", "seq", "map")}
"""What JSON has: no dates, sets, bytes or merged mappings."""


class _PlainConstructor(SafeConstructor):
    """Looks at all values before it makes any of them."""

    def construct_document(self, node: Node) -> Any:
        waiting, seen = [node], 0
        while waiting:
            each = waiting.pop()
            seen += 1
            if each.tag not in PLAIN:
                _refuse(f"{each.tag} is not a plain value", each)
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
    yaml = YAML(typ="safe", pure=True)  # not libyaml, which reads YAML 1.1
    yaml.Constructor = _PlainConstructor
    try:
        return yaml.load(text)
    except MarkedYAMLError as error:
        line = f", line {error.problem_mark.line + 1}" if error.problem_mark else ""
        problem, _, _ = error.problem.partition(" with value ")  # of a key's second, of any length
        raise UserError(f"{name}{line}: {problem}") from None
    except YAMLError as error:
        raise UserError(f"{name}: {str(error).splitlines()[0]}") from None
    except RecursionError:
        raise UserError(f"{name}: nested too deeply") from None
    except (ValueError, KeyError) as error:  # !!int one, a number of thousands of digits
        raise UserError(f"{name}: not a value of its kind ({error})") from None
