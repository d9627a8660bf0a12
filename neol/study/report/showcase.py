"""The champions that the report shows: each task's best in fresh episodes."""

import math
from collections.abc import Iterator
from pathlib import Path

import numpy as np
from pydantic import ConfigDict

from neol.base.errors import UserError
from neol.base.files import write_atomically
from neol.champions.player import Player, load_champion
from neol.pictures.film import film
from neol.pictures.labels import method_label, task_label
from neol.pictures.network import network_figure
from neol.pictures.style import rendered
from neol.spec.types import Model
from neol.study.campaign.grid import RESULTS, Cell, blocks
from neol.study.outcomes.campaign_runs import Campaign
from neol.study.outcomes.chosen_cells import candidates
from neol.study.report.common import command_line


class Shown(Model):
    """A champion of the report, with its pictures."""

    model_config = ConfigDict(ser_json_bytes="base64", val_json_bytes="base64")

    task: str
    record: str
    """Path of the record from the root."""
    seed: int
    title: str
    """Title of task, method, configuration and seed."""
    nodes: int
    """Number of hidden and output nodes."""
    connections: int
    """Number of enabled connections."""
    fitness: float
    held_out: float
    """Mean return of its fresh episodes."""
    episode_return: float | None
    """Return of the filmed episode, the median of the fresh ones; null if it was not filmed."""
    not_filmed: str | None
    """Reason why there is no film."""
    network: bytes
    """Drawing of the network, PNG."""
    film: bytes | None
    """Film of that episode, GIF."""


class Showcase(Model):
    """A budget's champions in the report: the content of champions.json."""

    champions: tuple[Shown, ...]


def best_champion(campaign: Campaign, task: str) -> tuple[Cell, int] | None:
    """Return cell and seed of a task's highest held-out mean in Table 1's cells; None without."""
    found = [
        (mean, cell, seed)
        for (of, _), cells in candidates(campaign.configuration, "table3").items()
        for cell in cells
        if of == task
        for seed, mean in campaign.runs(cell).held_out.items()
        if not math.isnan(mean)
    ]
    return max(found, key=lambda each: each[0])[1:] if found else None


def show(campaign: Campaign, results: Path) -> Iterator[Shown]:
    """Draw and film the best champion of each of a budget's tasks."""
    records = {
        (block.cell, seed): block.record
        for block in blocks(campaign.configuration)
        for seed in block.seeds
    }
    for task in campaign.configuration.budget.tasks:
        best = best_champion(campaign, task)
        if best is None:
            continue
        record = records[best]
        player = load_champion(results / record, best[1])
        shown = _shown(player, best[0], RESULTS / record)
        try:
            filmed = film(player, _median_episode(player))
        except UserError as reason:
            shown = shown.model_copy(update={"not_filmed": str(reason)})
        else:
            episode_return = filmed.trace.episode_return
            shown = shown.model_copy(update={"episode_return": episode_return, "film": filmed.gif})
        yield shown


def _shown(player: Player, cell: Cell, record: Path) -> Shown:
    rate = "" if cell.learning_rate is None else f", learning rate {cell.learning_rate:g}"
    returns = np.array(player.recorded_returns)
    return Shown(
        task=cell.task,
        record=record.as_posix(),
        seed=player.spec.seed,
        title=f"{task_label(cell.task)}: {method_label(cell.method)}, population "
        f"{cell.population}{rate}, seed {player.spec.seed}",
        nodes=len(player.network.bias),
        connections=len(player.network.weight),
        fitness=player.genome.fitness,
        held_out=float(np.nanmean(returns)),
        episode_return=None,
        not_filmed=None,
        network=rendered(network_figure(player), "png"),
        film=None,
    )


def _median_episode(player: Player) -> int:
    """Return the seed of the held-out episode of median return, the lower of two."""
    returns = np.array(player.recorded_returns)
    order = np.argsort(returns, kind="stable")[: np.isfinite(returns).sum()]
    return player.held_out_seeds[int(order[(len(order) - 1) // 2])]


def write_showcase(campaign: Campaign, output: Path) -> None:
    """Write the champions of a budget."""
    champions = Showcase(champions=tuple(show(campaign, RESULTS)))
    write_atomically(output, champions.model_dump_json(indent=1).encode())


if __name__ == "__main__":
    command_line("neol.study.report.showcase", __doc__, write_showcase, output="the file")
