"""The one kind of error that is the user's to mend, and what is said that is none."""

NOTICE = "neol: note: "
"""How a line of ours begins that tells of no error."""
INTERRUPTED, TERMINATED = "interrupted", "terminated"
"""How what follows `neol: ` begins where a run was stopped, which is no error either."""


class UserError(Exception):
    """Something outside neol is wrong: one line that says what, where, and how to mend it.

    Mostly the input; else what it runs on (a full disk) or with (an environment that raises).

    The command line prints the line and exits with 2; a stack trace is left to our own bugs.
    What a terminal would not show as it is, such as a line's end in a name, is escaped.
    """

    def __init__(self, line: str) -> None:
        super().__init__("".join(c if c.isprintable() else repr(c)[1:-1] for c in line))
