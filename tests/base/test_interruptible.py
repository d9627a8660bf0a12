"""Places at which Ctrl-C, SIGTERM and other signals raise their exceptions."""

import signal
from collections.abc import Iterator

import pytest

from neol.base.interruption import ENDING, Terminated, interruptible, stop_if_asked


@pytest.fixture(autouse=True)
def _default_handlers() -> Iterator[None]:
    before = signal.signal(signal.SIGINT, signal.default_int_handler)
    yield
    signal.signal(signal.SIGINT, before)


@pytest.mark.parametrize(
    ("sent", "raised"),
    [
        (signal.SIGINT, KeyboardInterrupt),
        (signal.SIGTERM, Terminated),
        (signal.SIGHUP, Terminated),
        (signal.SIGXCPU, Terminated),
    ],
)
def test_it_waits_until_somebody_looks(
    sent: signal.Signals, raised: type[KeyboardInterrupt]
) -> None:
    with interruptible():
        stop_if_asked()
        signal.raise_signal(sent)
        with pytest.raises(raised) as stop:
            stop_if_asked()
    assert stop.type is raised


def test_a_second_signal_does_not_wait() -> None:
    with interruptible():
        signal.raise_signal(signal.SIGINT)
        with pytest.raises(KeyboardInterrupt):
            signal.raise_signal(signal.SIGTERM)


@pytest.mark.parametrize("sent", [signal.SIGHUP, signal.SIGXCPU])
def test_what_is_sent_again_without_impatience_goes_on_waiting(sent: signal.Signals) -> None:
    with interruptible():
        signal.raise_signal(sent)
        signal.raise_signal(sent)
        with pytest.raises(Terminated):
            stop_if_asked()


def test_an_alarm_is_left_to_the_environment_that_set_it() -> None:
    rung: list[int] = []
    before = signal.signal(signal.SIGALRM, lambda number, _frame: rung.append(number))
    with interruptible():
        signal.raise_signal(signal.SIGALRM)
        stop_if_asked()
    signal.signal(signal.SIGALRM, before)
    assert rung == [signal.SIGALRM]


def test_what_is_ignored_stays_ignored() -> None:
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    with interruptible():
        signal.raise_signal(signal.SIGINT)
        stop_if_asked()


def test_afterwards_all_is_as_before() -> None:
    before = [signal.getsignal(number) for number in ENDING]
    with pytest.raises(KeyboardInterrupt), interruptible():
        signal.raise_signal(signal.SIGINT)
        stop_if_asked()
    assert [signal.getsignal(number) for number in ENDING] == before
    stop_if_asked()
