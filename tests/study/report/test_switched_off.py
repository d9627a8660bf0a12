"""Champions played again without plasticity, compared with Gymnasium's own environment."""

import itertools

import numpy as np
import pandas as pd
import pytest

from neol.champions.player import load_champion
from neol.spec.configuration import ROOT
from neol.study.campaign.grid import RESULTS, blocks
from neol.study.campaign.shown import select
from neol.study.outcomes.campaign_runs import Campaign
from neol.study.report.switched_off import COLUMNS, EPISODES, switched_off

pytestmark = pytest.mark.slow


def test_returns_are_those_of_the_plain_loop_that_never_learns() -> None:
    """Plays the first champions of `demo` on CartPole at the larger rate, in the same episodes."""
    campaign = Campaign(select("demo", "cartpole"), ROOT / RESULTS)
    rows = pd.DataFrame(
        itertools.islice(switched_off(campaign, ROOT / RESULTS), 12), columns=COLUMNS
    )
    records = {
        (block.cell.learning_rate, seed): block.record
        for block in blocks(campaign.configuration)
        for seed in block.seeds
        if block.cell.method == "hebb"
    }
    row = rows[(rows["learning_rate"] == 0.25) & (rows["seed"] == 1)].iloc[0]
    player = load_champion(ROOT / RESULTS / records[0.25, 1], 1)
    seeds = player.held_out_seeds[:EPISODES]
    fixed = [player.play(seed, plastic_steps=0).episode_return for seed in seeds]
    plastic = [player.play(seed).episode_return for seed in seeds]
    assert (row["fixed"], row["plastic"]) == (np.mean(fixed), np.mean(plastic))
    assert row["episodes"] == EPISODES
    assert set(rows["method"]) == {"hebb"}
