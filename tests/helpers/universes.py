"""Made-up records of the multiverse."""

from collections.abc import Mapping
from pathlib import Path

from neol.study.campaign.grid import run_specs
from neol.study.campaign.multiverse import BUDGET, Universe, configuration, method_blocks
from tests.helpers.made_up import run, write_runs


def write_universe(results: Path, universe: Universe, task: str, ends: Mapping[str, float]) -> None:
    """Write each method's runs of a task under a reading: they end at these values, and around.

    What another reading shares is written again.
    """
    for method, end in ends.items():
        here = configuration(universe, method)
        for block in method_blocks(universe, method):
            if block.cell.task == task:
                specs = run_specs(here, block)
                runs = [run(spec, BUDGET, end + spec.seed % 5, here.reading) for spec in specs]
                write_runs(results / block.record, runs)
