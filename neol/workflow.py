"""What the Snakefile asks of the library: what to run and why, and whether it is alone."""

import fcntl
import platform
import re
import shlex
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import IO

from neol.campaign import RESULTS, blocks, run_specs
from neol.errors import UserError
from neol.records import first_difference, read_spec
from neol.sensitivity import trials, variants
from neol.spec import Configuration, RunSpec


@dataclass(frozen=True, slots=True)
class Job:
    """One call of `neol run`, and the record that it makes."""

    record: Path
    budget: str
    spec: RunSpec
    """With the first of its seeds."""
    seeds: range
    overrides: Sequence[str] = ()

    @property
    def arguments(self) -> str:
        """The job as the command line of `neol run` has it."""
        spec = self.spec
        options = {
            "budget": self.budget,
            "task": spec.task.name,
            "method": spec.method,
            "population": spec.population,
            "generations": spec.generations,
            "seed": f"{self.seeds[0]}-{self.seeds[-1]}",
        }
        if spec.plasticity.rule != "none":
            options["learning-rate"] = spec.plasticity.learning_rate
        words = [word for name, value in options.items() for word in (f"--{name}", str(value))]
        return shlex.join([*words, *(word for each in self.overrides for word in ("--set", each))])

    def reason(self) -> str | None:
        """Why the record must be made; None where it is there and of this specification.

        The record itself says what it was made of, whoever made it, wherever, whenever. One that
        cannot be read counts as there: it is not overwritten, and its readers say what it is.
        """
        if not self.record.exists():
            return f"{self.record} is missing"
        try:
            difference = first_difference(read_spec(self.record), self.spec)
        except UserError:
            return None
        return difference and f"{self.record} is of another specification: {difference}"


def jobs(configuration: Configuration) -> Iterator[Job]:
    """All of a budget: its cells' blocks, and the trials of the sensitivity study."""
    budget = configuration.budget.name
    for block in blocks(configuration):
        yield Job(block.record, budget, run_specs(configuration, block)[0], block.seeds)
    for name, variant in variants().items():
        for trial in trials(configuration, name):
            yield Job(trial.record, budget, trial.spec, trial.seeds, variant.set)


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
    here. Without such locks, or where another machine came first, nothing is removed.
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
