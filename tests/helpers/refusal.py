"""Checks that input is refused in one line."""

from collections.abc import Callable
from typing import TypeVar

import pytest

from neol.base.errors import UserError

T = TypeVar("T")


def refusal(call: Callable[..., object], *arguments: object, **keywords: object) -> str:
    """Return the line with which a call refuses its arguments."""
    with pytest.raises(UserError) as raised:
        call(*arguments, **keywords)
    return _line(raised.value)


def survive(read: Callable[[], T], says: str = "") -> T | None:
    """Check that a call loads its input or refuses it in one line."""
    try:
        return read()
    except UserError as error:
        assert says in _line(error)
        return None


def _line(error: UserError) -> str:
    text = str(error)
    assert text
    assert "\n" not in text
    return text
