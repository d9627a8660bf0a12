"""Ctrl-C and SIGTERM: a signal asks a run to stop; the run checks for it between steps of work."""

import contextlib
import signal
from collections.abc import Iterator
from types import FrameType


class Terminated(KeyboardInterrupt):
    """Interrupt raised by SIGTERM."""


_asked: type[KeyboardInterrupt] | None = None


def stop_if_asked() -> None:
    """Raise KeyboardInterrupt after Ctrl-C and Terminated after SIGTERM, within `interruptible`.

    Long computations call it between two pieces of work.
    """
    if _asked is not None:
        raise _asked


@contextlib.contextmanager
def interruptible() -> Iterator[None]:
    """Defer Ctrl-C and SIGTERM to the next `stop_if_asked`; a second signal acts at once.

    An exception raised in a signal handler could surface where a library expects none, in a
    finaliser or during compilation. A signal that is ignored outside (Ctrl-C in a shell's
    background) stays ignored.
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
