"""Ctrl-C and SIGTERM, raised where neol's own code is at work and never within a library's."""

import contextlib
import signal
from collections.abc import Iterator
from types import FrameType

_AGAIN_SECONDS = 0.02


class Terminated(KeyboardInterrupt):
    """SIGTERM, taken as an interrupt."""


@contextlib.contextmanager
def interruptible() -> Iterator[None]:
    """Raise KeyboardInterrupt on Ctrl-C and Terminated on SIGTERM, at the next safe moment.

    A library may run Python where it expects no exception, in a finaliser or in the midst of
    compiling. So the exception waits until neol's own code is on top of the stack again; a second
    signal does not wait. What is ignored outside, as Ctrl-C in a shell's background, stays so.
    """
    asked: type[KeyboardInterrupt] | None = None

    def ask(number: int, frame: FrameType | None) -> None:
        nonlocal asked
        impatient = asked is not None
        asked = Terminated if number == signal.SIGTERM else KeyboardInterrupt
        raise_or_wait(frame, impatient)

    def look_again(_number: int, frame: FrameType | None) -> None:
        raise_or_wait(frame, impatient=False)

    def raise_or_wait(frame: FrameType | None, impatient: bool) -> None:
        nonlocal asked
        if asked is None:
            return
        if impatient or _is_ours(frame):
            stop, asked = asked, None
            raise stop
        signal.setitimer(signal.ITIMER_REAL, _AGAIN_SECONDS)

    handlers = {signal.SIGTERM: ask, signal.SIGINT: ask, signal.SIGALRM: look_again}
    before = {
        number: signal.signal(number, handler)
        for number, handler in handlers.items()
        if signal.getsignal(number) != signal.SIG_IGN
    }
    try:
        yield
    finally:
        signal.setitimer(signal.ITIMER_REAL, 0)
        for number, handler in before.items():
            signal.signal(number, handler)


def _is_ours(frame: FrameType | None) -> bool:
    return frame is not None and frame.f_globals.get("__name__", "").partition(".")[0] == "neol"
