"""Where the exceptions of Ctrl-C and SIGTERM come out."""

import signal
from collections.abc import Iterator

import pytest

from neol.base.interruption import Terminated, interruptible

OURS = {"__name__": "neol.made_up"}
"""A module whose code is neol's own; that of these tests is not."""


@pytest.fixture(autouse=True)
def _default_handlers() -> Iterator[None]:
    before = signal.signal(signal.SIGINT, signal.default_int_handler)
    yield
    signal.signal(signal.SIGINT, before)


@pytest.mark.parametrize(
    ("sent", "raised"), [(signal.SIGINT, KeyboardInterrupt), (signal.SIGTERM, Terminated)]
)
def test_it_waits_until_a_library_has_returned(
    sent: signal.Signals, raised: type[KeyboardInterrupt]
) -> None:
    returned = False
    with pytest.raises(raised) as stop, interruptible():
        signal.raise_signal(sent)
        sum(range(10**6))
        returned = True
        exec("while True: pass", dict(OURS))
    assert returned
    assert stop.type is raised


def test_in_our_code_it_comes_at_once() -> None:
    code = OURS | {"signal": signal, "went_on": False}
    with pytest.raises(KeyboardInterrupt), interruptible():
        exec("signal.raise_signal(signal.SIGINT)\nwent_on = True", code)
    assert not code["went_on"]


def test_a_second_signal_does_not_wait() -> None:
    with pytest.raises(KeyboardInterrupt), interruptible():
        signal.raise_signal(signal.SIGINT)
        signal.raise_signal(signal.SIGINT)
        pytest.fail("went on")


def test_what_is_ignored_stays_ignored() -> None:
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    with interruptible():
        signal.raise_signal(signal.SIGINT)
        exec("for _ in range(10**6): pass", dict(OURS))


def test_handlers_are_as_before_afterwards() -> None:
    watched = (signal.SIGINT, signal.SIGTERM, signal.SIGALRM)
    before = [signal.getsignal(number) for number in watched]
    with pytest.raises(KeyboardInterrupt), interruptible():
        signal.raise_signal(signal.SIGINT)
        exec("while True: pass", dict(OURS))
    assert [signal.getsignal(number) for number in watched] == before
    assert signal.getitimer(signal.ITIMER_REAL) == (0.0, 0.0)
