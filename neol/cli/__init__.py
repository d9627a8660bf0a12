"""The command line. A module a group of commands; each command imports what is heavy by itself."""

from neol.cli import champions, config, run, status, study, verify
from neol.cli.application import app

__all__ = ["app", "champions", "config", "run", "status", "study", "verify"]
