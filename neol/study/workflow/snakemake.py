"""Functions for the Snakefile: a pattern for its records, refusals, and removal of stale locks."""

import fcntl
import os
import platform
import re
from collections.abc import Iterable, Mapping, Sequence
from pathlib import Path
from typing import IO

from neol.base.errors import UserError
from neol.spec.configuration import PAPER_BUDGET, Configuration
from neol.spec.constants import Budget
from neol.study.campaign.grid import RESULTS
from neol.study.campaign.shown import figures_folder
from neol.study.workflow.exhibits import HEAT_MAPS, exhibits


def pattern(records: Iterable[Path]) -> str:
    """Return a regular expression for the records' paths below results/, without suffix.

    It is grouped by folder, because Snakemake tries each alternative on every file.
    """
    folders: dict[Path, list[str]] = {}
    for record in records:
        folders.setdefault(record.relative_to(RESULTS).parent, []).append(re.escape(record.stem))
    alternatives = (f"{re.escape(str(f))}/(?:{'|'.join(names)})" for f, names in folders.items())
    return "|".join(alternatives) or "(?!)"


def refuse_braces(*paths: Path) -> None:
    """Raise UserError if a path has a brace, which Snakemake takes for the beginning of a name."""
    for path in paths:
        if set("{}") & set(str(path)):
            raise UserError(f"{path}: Snakemake cannot work below a name with a brace; rename it")


def refuse_unknown_exhibits(arguments: Iterable[str], configuration: Configuration) -> None:
    """Raise UserError if an argument names a table or figure that is not made.

    Snakemake would say only that no rule produces it.
    """
    made = exhibits(configuration.budget, "tables", "figures")
    folder = figures_folder(configuration)
    suffixes = {each.name: each.group.suffixes for each in made}
    files = {f"{folder}/{name}.{suffix}" for name in suffixes for suffix in suffixes[name]}
    for argument in arguments:
        if not re.fullmatch(r"(\S+/)?(table|figure)\d+(\.\w+)?", argument) or argument in files:
            continue
        name = Path(argument).stem
        raise UserError(
            f"{argument}: budget {configuration.budget.name} makes no such file"
            f"{_why(name, folder, suffixes, configuration.budget)} (in {folder}/: "
            f"{', '.join(suffixes)}; --config budget=NAME for another budget)"
        )


def _why(name: str, folder: Path, made: Mapping[str, Sequence[str]], budget: Budget) -> str:
    """Return what may be meant instead of a missing table or figure, or why it is not made."""
    if name in made:
        return f", did you mean {folder}/{name}.{made[name][0]}?"
    if HEAT_MAPS.get(name) in budget.tasks:
        return f": {name} needs the whole grid, as budget {PAPER_BUDGET} has it"
    return ""


def clear_stale_locks(folder: Path = Path(".snakemake")) -> IO[str] | None:
    """Remove the locks of killed workflows; the caller must keep the returned file open.

    Snakemake's locks are files and outlive it. Each workflow also holds a shared lock of the
    operating system, which ends with the process; getting it exclusively proves that no other
    workflow runs here. Without such locks, or if another machine came first, nothing is removed.
    Between the exclusive and the shared lock there is an instant without any (flock(2)); a
    workflow that starts then finds no locks yet, since Snakemake makes them later. Raises UserError
    if the folder cannot be written.
    """
    try:
        folder.mkdir(exist_ok=True)
        file = (folder / "alive").open("a+")
    except OSError as error:
        raise _cannot_be_written(folder, error) from None
    try:
        fcntl.flock(file, fcntl.LOCK_EX | fcntl.LOCK_NB)
    except BlockingIOError:
        pass
    except OSError:
        return None
    else:
        file.seek(0)
        if (machine := file.read()) not in ("", platform.node()):
            return None
        if not machine:
            try:
                _save(file, platform.node())
            except OSError as error:
                raise _cannot_be_written(folder, error) from None
        for lock in (folder / "locks").glob("*.lock"):
            lock.unlink()
    fcntl.flock(file, fcntl.LOCK_SH)
    return file


def _save(file: IO[str], text: str) -> None:
    """Write text to the disk, where other machines see it while the file stays open."""
    file.write(text)
    file.flush()
    os.fsync(file.fileno())


def _cannot_be_written(folder: Path, error: OSError) -> UserError:
    return UserError(
        f"{folder.absolute()}: cannot be written ({error.strerror}); Snakemake needs it, even "
        "for a dry run: copy the checkout (git clone) to where you may write"
    )
