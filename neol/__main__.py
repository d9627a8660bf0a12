"""`python -m neol` is `neol`."""

from neol.cli import app

app(prog_name="neol")
