"""Ctrl-C, SIGTERM and others ask a run to stop; it checks for that between steps of work."""

import contextlib
import signal
from collections.abc import Iterator
from types import FrameType

REPEATED = (signal.SIGHUP, signal.SIGXCPU)
"""Signals of a closed terminal and a CPU limit. The system repeats them, so a second one does not
mean that the user wants an immediate end."""
ENDING = (signal.SIGINT, signal.SIGTERM, *REPEATED)
"""Signals that ask a run to stop; environments may use all others, such as SIGALRM."""


class Terminated(KeyboardInterrupt):
    """Interrupt raised by SIGTERM, SIGHUP or SIGXCPU."""


_asked: type[KeyboardInterrupt] | None = None


def stop_if_asked() -> None:
    """Raise KeyboardInterrupt after Ctrl-C, Terminated after others, within `interruptible`.

    Long computations call it between two pieces of work.
    """
    if _asked is not None:
        raise _asked


@contextlib.contextmanager
def interruptible() -> Iterator[None]:
    """Defer `ENDING` signals to the next `stop_if_asked`; a second Ctrl-C or SIGTERM acts at once.

    An exception raised in a signal handler could surface where a library expects none, in a
    finaliser or during compilation. A signal that is ignored outside (Ctrl-C in a shell's
    background) stays ignored.
    """
    global _asked

    def ask(number: int, _frame: FrameType | None) -> None:
        global _asked
        if number not in REPEATED:
            stop_if_asked()
        _asked = KeyboardInterrupt if number == signal.SIGINT else Terminated

    before = {
        number: signal.signal(number, ask)
        for number in ENDING
        if signal.getsignal(number) != signal.SIG_IGN
    }
    try:
        yield
    finally:
        for number, handler in before.items():
            signal.signal(number, handler)
        _asked = None
