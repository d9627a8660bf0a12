"""Pages that are written when the site is built: the reference of the command line."""

import re
import subprocess
import sys

from mkdocs.config.defaults import MkDocsConfig
from mkdocs.structure.files import File, Files

COMMAND_LINE = "reference/command-line.md"
EXAMPLES = re.compile(r"^Examples:\n((?:  .*\n?)+)", re.MULTILINE)
SECTION = re.compile(r"^## `neol (\w+)`\n\n(.*)$", re.MULTILINE)
"""A command's heading and summary."""
CUT = re.compile(r"^\* `(\w+)`: .*\.\.\.$", re.MULTILINE)
"""An entry in the list of commands, whose summary typer cuts."""


def on_files(files: Files, config: MkDocsConfig) -> Files:
    """Add what each command's help says."""
    files.append(File.generated(config, COMMAND_LINE, content=command_line()))
    return files


def command_line() -> str:
    """All commands as one page of Markdown."""
    documented = [sys.executable, "-m", "typer", "neol.cli", "utils", "docs", "--name", "neol"]
    text = subprocess.run(documented, check=True, capture_output=True, text=True).stdout
    text = text.replace("# `neol`\n", "# Command line\n", 1)  # the start page is called neol
    summaries = dict(SECTION.findall(text))
    text = CUT.sub(lambda entry: f"* `{entry[1]}`: {summaries[entry[1]]}", text)
    return EXAMPLES.sub(r"Examples:\n\n```console\n\1```\n", text)
