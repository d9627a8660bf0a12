"""Run `neol` as `python -m neol`."""

from neol.cli import app

app(prog_name="neol")
