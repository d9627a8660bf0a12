"""The jobs of a budget: the call of `neol run` for each record, and whether it is needed."""

import shlex
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path

from neol.base.errors import UserError
from neol.run.record_file import RecordMetadata, first_difference, read_footer
from neol.spec.configuration import Configuration
from neol.spec.run_spec import RunSpec
from neol.study.campaign.grid import RESULTS, blocks, run_specs
from neol.study.campaign.variants import trials, variants

SENSITIVITY = "sensitivity"


@dataclass(frozen=True, slots=True)
class Job:
    """One call of `neol run`, and its record."""

    record: Path
    log: Path
    """Output of the call in the workflow."""
    reading: str
    budget: str
    part: str
    """Part of the campaign: a method, or `SENSITIVITY`."""
    spec: RunSpec
    """Specification with the first seed."""
    seeds: range
    overrides: Sequence[str] = ()

    @property
    def arguments(self) -> str:
        """Arguments of the call of `neol run`."""
        spec = self.spec
        options = {
            "reading": self.reading,
            "budget": self.budget,
            "task": spec.task.name,
            "method": spec.method,
            "population": spec.population,
            "generations": spec.generations,
            "seed": f"{self.seeds[0]}-{self.seeds[-1]}",
        }
        if spec.plasticity.learns:
            options["learning-rate"] = spec.plasticity.learning_rate
        words = [word for name, value in options.items() for word in (f"--{name}", str(value))]
        return shlex.join([*words, *(word for each in self.overrides for word in ("--set", each))])

    def reason(self) -> str | None:
        """Return why the record must be made; None if it exists with this specification and seeds.

        Only the record itself decides, not its time or place. A file that cannot be read counts as
        existing: it is not overwritten, and its readers report it.
        """
        if not self.record.exists():
            return f"{self.record} is missing"
        try:
            return self.misfit(read_footer(self.record))
        except UserError:
            return None

    def misfit(self, footer: RecordMetadata) -> str | None:
        """Return why a record with this footer must be made again; None if it fits the job."""
        if difference := first_difference(footer.spec, self.spec):
            return f"{self.record} is of another specification: {difference}"
        if {info.seed for info in footer.seeds} != set(self.seeds):
            return f"{self.record} is of other seeds than {self.seeds[0]} to {self.seeds[-1]}"
        return None


def jobs(configuration: Configuration, results: Path = RESULTS) -> Iterator[Job]:
    """Yield all jobs of a budget: its cells' blocks and the trials of the sensitivity study."""
    reading, own = configuration.reading, configuration.budget.name
    logs = results.absolute().parent / "logs"

    def job(
        below: Path,
        budget: str,
        part: str,
        spec: RunSpec,
        seeds: range,
        overrides: Sequence[str] = (),
    ) -> Job:
        log = (logs / below).with_suffix(".log")
        return Job(results / below, log, reading, budget, part, spec, seeds, overrides)

    for block in blocks(configuration):
        spec = run_specs(configuration, block)[0]
        yield job(block.record, block.home.name, block.cell.method, spec, block.seeds)
    for name, variant in variants().items():
        for trial in trials(configuration, name):
            yield job(trial.record, own, SENSITIVITY, trial.spec, trial.seeds, variant.set)
