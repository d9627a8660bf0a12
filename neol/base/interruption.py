"""Ctrl-C and SIGTERM: a run is asked to stop, and stops at the next place that looks."""

import contextlib
import signal
from collections.abc import Iterator
from types import FrameType


class Terminated(KeyboardInterrupt):
    """SIGTERM, taken as an interrupt."""


_asked: type[KeyboardInterrupt] | None = None


def stop_if_asked() -> None:
    """Raise KeyboardInterrupt after Ctrl-C and Terminated after SIGTERM, within `interruptible`.

    Called by whatever takes long, between two pieces of its work.
    """
    if _asked is not None:
        raise _asked


@contextlib.contextmanager
def interruptible() -> Iterator[None]:
    """Let Ctrl-C and SIGTERM wait for `stop_if_asked`; a second signal does not wait.

    An exception out of a signal's handler could come up where a library expects none, in a
    finaliser or in the midst of compiling. What is ignored outside, as Ctrl-C in a shell's
    background, stays so.
    """
    global _asked

    def ask(number: int, _frame: FrameType | None) -> None:
        global _asked
        stop_if_asked()
        _asked = Terminated if number == signal.SIGTERM else KeyboardInterrupt

    before = {
        number: signal.signal(number, ask)
        for number in (signal.SIGTERM, signal.SIGINT)
        if signal.getsignal(number) != signal.SIG_IGN
    }
    try:
        yield
    finally:
        for number, handler in before.items():
            signal.signal(number, handler)
        _asked = None
