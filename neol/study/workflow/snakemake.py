"""What only the Snakefile asks: a pattern for its records, and whether it is alone."""

import fcntl
import platform
import re
from collections.abc import Iterable
from pathlib import Path
from typing import IO

from neol.study.campaign.grid import RESULTS


def pattern(records: Iterable[Path]) -> str:
    """A regular expression that matches these records: their paths below results/, no suffix.

    By folder: Snakemake tries it on every file, alternative by alternative.
    """
    folders: dict[Path, list[str]] = {}
    for record in records:
        folders.setdefault(record.relative_to(RESULTS).parent, []).append(re.escape(record.stem))
    alternatives = (f"{re.escape(str(f))}/(?:{'|'.join(names)})" for f, names in folders.items())
    return "|".join(alternatives) or "(?!)"


def clear_stale_locks(folder: Path = Path(".snakemake")) -> IO[str] | None:
    """Remove the locks of workflows that were killed; the caller keeps the result, to be seen.

    Snakemake's locks are files and outlive it. Every workflow also holds a shared lock of the
    kernel's, which ends with the process: who gets it exclusively knows that no other one lives
    here. Without such locks, or where another machine came first, nothing is removed. From the
    exclusive to the shared lock there is an instant without any (flock(2)); another workflow that
    comes then finds no locks yet, as Snakemake makes them later.
    """
    try:
        folder.mkdir(exist_ok=True)
        file = (folder / "alive").open("a+")
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
            file.write(platform.node())
        for lock in (folder / "locks").glob("*.lock"):
            lock.unlink()
    fcntl.flock(file, fcntl.LOCK_SH)
    return file
