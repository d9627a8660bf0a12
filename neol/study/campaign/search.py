"""The search for readings that reproduce the paper's baselines: its runs and their order.

Its plan is docs/readings-plan.md. `python -m neol.study.campaign.search search` prints the
arguments of one call of snakemake for each reading, `... confirmation READING` those of some.
"""

import argparse
from collections.abc import Iterable, Mapping, Sequence

from neol.base.ending import exit_codes
from neol.base.errors import UserError, hint
from neol.network.rules import BASELINES
from neol.spec.configuration import CONFIG, load_configuration
from neol.spec.sources import Overlay
from neol.spec.types import Model, Text
from neol.study.campaign.grid import RESULTS, Block, blocks

CANDIDATES = CONFIG / "search" / "candidates.yaml"
SCREENING, CONFIRMATION = "search", "confirmation"
"""Budgets of the two stages."""


class Candidate(Model):
    """A reading that is compared with the paper's baselines."""

    neat_wo: Text | None = None
    """Reading with the same runs of NEAT (w/o), which are not repeated; None if they differ."""


def candidates() -> dict[str, Candidate]:
    """Return the candidates by reading, in the order of their runs.

    Raises UserError for an invalid file.
    """
    overlay = Overlay.of(CANDIDATES)
    found = overlay.parse(dict[str, Candidate])
    for name, candidate in found.items():
        if candidate.neat_wo is not None and found.get(candidate.neat_wo) != Candidate():
            place = overlay.place((name, "neat_wo"))
            raise UserError(f"{place} = {candidate.neat_wo}: has no runs of NEAT (w/o) of its own")
    return found


def source(reading: str, method: str) -> str:
    """Return the reading whose records hold a candidate's runs of a baseline.

    It is the candidate, or the reading with the same runs. Raises UserError if not a candidate.
    """
    known = candidates()
    if reading not in known:
        raise UserError(f'"{reading}" is not a candidate of the search{hint(reading, known)}')
    return (method == "neat_wo" and known[reading].neat_wo) or reading


def baseline_blocks(reading: str, method: str, budget: str) -> list[Block]:
    """Return the records of a candidate's runs of a baseline. Raises UserError as `source` does."""
    configuration = load_configuration(budget, reading=source(reading, method))
    return [block for block in blocks(configuration) if block.cell.method == method]


def calls(budget: str, readings: Sequence[str]) -> list[str]:
    """Return the arguments of the calls of snakemake that make some candidates' records in turn."""
    wanted: dict[str, dict[Block, None]] = {}
    for reading in readings:
        for method in BASELINES:
            asked = baseline_blocks(reading, method, budget)
            wanted.setdefault(source(reading, method), {}).update(dict.fromkeys(asked))
    return workflow_calls(budget, wanted)


def workflow_calls(budget: str, wanted: Mapping[str, Iterable[Block]]) -> list[str]:
    """Return for each reading the arguments of the call of snakemake that makes its records."""
    return [
        f"{' '.join(str(RESULTS / block.record) for block in asked)} "
        f"--config budget={budget} reading={reading}"
        for reading, asked in wanted.items()
    ]


if __name__ == "__main__":
    parser = argparse.ArgumentParser(prog="python -m neol.study.campaign.search")
    parser.add_argument("budget", choices=(SCREENING, CONFIRMATION))
    parser.add_argument("readings", nargs="*", help="candidates; all by default")
    arguments = parser.parse_args()
    with exit_codes():
        print(*calls(arguments.budget, arguments.readings or list(candidates())), sep="\n")
