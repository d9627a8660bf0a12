"""The command line: one module for each group of commands; commands import heavy modules late."""

from neol.cli import champions, config, run, status, study, verify
from neol.cli.application import app

__all__ = ["app", "champions", "config", "run", "status", "study", "verify"]
