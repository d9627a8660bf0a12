"""Made-up records: a campaign's folder with known statistics."""

from collections.abc import Mapping, Sequence
from pathlib import Path

import numpy as np

from neol.neat.genome import initial_genome
from neol.run.evolution import Generation
from neol.run.provenance import provenance
from neol.run.record import Champion, HeldOut, Record, SeedInfo, history_table, join
from neol.run.record_file import write_record
from neol.spec.configuration import Configuration, load_configuration
from neol.spec.readings import DEFAULT_READING
from neol.spec.run_spec import RunSpec
from neol.study.campaign.grid import Block, Cell, blocks, run_specs
from neol.study.campaign.variants import trials


def configuration(
    *,
    tasks: Sequence[str] = ("cartpole",),
    generations: int = 2,
    seeds: int = 3,
    reading: str = DEFAULT_READING,
) -> Configuration:
    """The smoke budget (P = 6, 12, two rates) with other tasks, generations and seeds."""
    return load_configuration(
        "smoke",
        [
            f"budget.tasks=[{', '.join(tasks)}]",
            f"budget.generations={generations}",
            f"budget.seeds={seeds}",
            f"budget.seeds_per_job={seeds}",
            "evaluation.held_out_episodes=1",
        ],
        reading=reading,
    )


def write_campaign(
    results: Path,
    configuration: Configuration,
    final_best: Mapping[Cell, Sequence[float | None]],
    otherwise: float = 0.0,
) -> None:
    """Write a record for each block; a cell that `final_best` names gets those values by seed.

    Every other run ends at `otherwise`. None leaves a seed out.
    """
    for block in blocks(configuration):
        values = final_best.get(
            block.cell, [otherwise] * len(configuration.budget.seeds_of(block.cell.task))
        )
        runs = [
            run(spec, configuration.budget.name, value, configuration.reading)
            for spec, value in zip(run_specs(configuration, block), _of(values, block), strict=True)
            if value is not None
        ]
        if runs:
            write_runs(results / block.record, runs)


def write_runs(path: Path, runs: Sequence[Record]) -> None:
    """Write runs into one record, with the folders that it needs."""
    path.parent.mkdir(parents=True, exist_ok=True)
    write_record(path, join(runs))


def write_trials(results: Path, configuration: Configuration, gains: Mapping[str, float]) -> None:
    """Write the sensitivity study's records for some variants.

    The seeds of each end at 0, 1, ... and the variant's gain more.
    """
    for name, gain in gains.items():
        for trial in trials(configuration, name):
            specs = [trial.spec.model_copy(update={"seed": seed}) for seed in trial.seeds]
            budget, reading = configuration.budget.name, configuration.reading
            runs = [run(spec, budget, gain + place, reading) for place, spec in enumerate(specs)]
            write_runs(results / trial.record, runs)


def run(
    spec: RunSpec,
    budget: str,
    final_best: float,
    reading: str = DEFAULT_READING,
    decline: float = 1.0,
) -> Record:
    """Return a run whose best fitness is higher by `decline` in each earlier generation.

    So only the final generation may count. Its champion returns 1 less in held-out episodes.
    """
    history = [
        generation(number, final_best + decline * (spec.generations - number), spec.population)
        for number in range(1, spec.generations + 1)
    ]
    genome = initial_genome(0, 1, 1, np.zeros(1), np.zeros(1))
    genome.fitness = final_best
    info = SeedInfo(
        seed=spec.seed,
        digest=f"{spec.seed:064x}",
        inputs=1,
        outputs=1,
        champion=Champion.of(genome),
        held_out=HeldOut.of(np.full(spec.evaluation.held_out_episodes, final_best - 1)),
        engine="made_up",
        wall_seconds=0.0,
        cpu_seconds=0.0,
        provenance=provenance(),
    )
    return Record(
        spec,
        budget,
        reading,
        history_table(spec.seed, history),
        (info,),
    )


def generation(number: int, best_fitness: float, population: int) -> Generation:
    return Generation(
        generation=number,
        best_fitness=best_fitness,
        mean_fitness=0.0,
        sd_fitness=0.0,
        evaluations=number * population,
        env_steps=10 * number * population,
        species=1,
        nodes_mean=1.0,
        connections_mean=1.0,
        nodes_best=1,
        connections_best=1,
        weight_change_mean=1.0,
        failed_evaluations=0,
    )


def _of(values: Sequence[float | None], block: Block) -> Sequence[float | None]:
    return values[block.first : block.last + 1]
