"""Made-up records of the search for readings."""

from pathlib import Path

from neol.spec.configuration import load_configuration
from neol.study.campaign.grid import run_specs
from neol.study.campaign.search import SCREENING, baseline_blocks, source
from tests.helpers.made_up import run, write_runs

PAPER = {"neat": (311.77, 8.18, 291.3), "neat_wo": (312.50, 8.97, 286.0)}
"""The paper's final best fitness, its standard deviation, and the mean best fitness."""


def write_baseline(
    results: Path,
    reading: str,
    method: str,
    numbers: tuple[float, float, float],
    budget: str = SCREENING,
) -> None:
    """Write the records of a baseline whose final values have a given mean and deviation.

    Its mean best fitness is the third number plus as much as the final value is off its mean.
    """
    final, sd, mean = numbers
    configuration = load_configuration(budget, reading=source(reading, method))
    blocks = baseline_blocks(reading, method, budget)
    middle = (len(blocks) - 1) / 2
    scale = (
        sd / (sum((place - middle) ** 2 for place in range(len(blocks))) / (len(blocks) - 1)) ** 0.5
    )
    for place, block in enumerate(blocks):
        (spec,) = run_specs(configuration, block)
        decline = (mean - final) / ((spec.generations - 1) / 2)
        record = run(spec, budget, final + scale * (place - middle), configuration.reading, decline)
        write_runs(results / block.record, [record])
