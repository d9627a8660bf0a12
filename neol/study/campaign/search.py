"""The search for readings that make the paper's baselines: what is run, in which order.

docs/readings-plan.md is its plan. `python -m neol.study.campaign.search search` prints the
arguments of one call of snakemake for each reading, `... confirmation READING` those of some.
"""

import argparse
import json
from collections.abc import Iterable, Mapping, Sequence

from pydantic import TypeAdapter, ValidationError

from neol.base.ending import exit_codes
from neol.base.errors import UserError, hint, one_line
from neol.network.rules import WITHOUT_RULE
from neol.spec.configuration import CONFIG, load_configuration
from neol.spec.sources import Overlay
from neol.spec.types import Model, Text
from neol.study.campaign.grid import RESULTS, Block, blocks

CANDIDATES = CONFIG / "search" / "candidates.yaml"
SCREENING, CONFIRMATION = "search", "confirmation"
"""The budgets of its two stages."""
BASELINES = tuple(WITHOUT_RULE)
"""The methods that are compared with the paper's."""


class Candidate(Model):
    """A reading that is compared with the paper's baselines."""

    neat_wo: Text | None = None
    """The reading whose runs of NEAT (w/o) its own would repeat; None where it has its own."""


def candidates() -> dict[str, Candidate]:
    """The candidates by reading, in the order in which they are run.

    Raises UserError for what the file may not state.
    """
    overlay = Overlay()
    overlay.add_file(CANDIDATES)
    kind = dict[str, Candidate]
    try:
        found = TypeAdapter(kind).validate_json(json.dumps(overlay.values))
    except ValidationError as error:
        raise UserError(one_line(error, kind, overlay.place)) from None
    for name, candidate in found.items():
        if candidate.neat_wo is not None and found.get(candidate.neat_wo) != Candidate():
            place = overlay.place((name, "neat_wo"))
            raise UserError(f"{place} = {candidate.neat_wo}: has no runs of NEAT (w/o) of its own")
    return found


def source(reading: str, method: str) -> str:
    """The reading whose records are a candidate's runs of a baseline: its own, or the same ones.

    Raises UserError for a reading that is no candidate.
    """
    known = candidates()
    if reading not in known:
        raise UserError(f'"{reading}" is no candidate of the search{hint(reading, known)}')
    return (method == "neat_wo" and known[reading].neat_wo) or reading


def baseline_blocks(reading: str, method: str, budget: str) -> list[Block]:
    """The records of a candidate's runs of a baseline. Raises UserError as `source` does."""
    configuration = load_configuration(budget, reading=source(reading, method))
    return [block for block in blocks(configuration) if block.cell.method == method]


def calls(budget: str, readings: Sequence[str]) -> list[str]:
    """The arguments of the calls of snakemake that make the records of some candidates in turn."""
    wanted: dict[str, dict[Block, None]] = {}
    for reading in readings:
        for method in BASELINES:
            asked = baseline_blocks(reading, method, budget)
            wanted.setdefault(source(reading, method), {}).update(dict.fromkeys(asked))
    return workflow_calls(budget, wanted)


def workflow_calls(budget: str, wanted: Mapping[str, Iterable[Block]]) -> list[str]:
    """The arguments of a call of snakemake for each reading: it makes the records of its blocks."""
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
