"""The one kind of error that is the user's to mend."""


class UserError(Exception):
    """Something in the input is wrong: one line that says what, where, and how to mend it.

    The command line prints the line and exits with 2; a stack trace is left to our own bugs.
    """
