"""Runs to play with: found, chosen, tabulated."""

from pathlib import Path

import pytest
import traitlets

from neol.base.errors import UserError
from neol.run.catalogue import find_records, table_of_runs
from neol.study.campaign.grid import RESULTS, Cell, blocks
from neol.study.campaign.variants import trials
from neol.study.explore.panel import RunChoice, episode_seed, load_player
from tests.helpers.made_up import configuration, run, write_campaign, write_runs

CONFIGURATION = configuration()
HEBB = "rare_mutation/smoke/cartpole/hebb/p006_lr0.25/seeds_000-002.parquet"
BEST = {
    Cell("cartpole", "hebb", 6, 0.25): (1.0, 2.0, 3.0),
    Cell("cartpole", "neat", 6, None): (4.0, None, 5.0),
}


@pytest.fixture(scope="module")
def results(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A campaign, an unfinished block and a variant of the sensitivity study."""
    results = tmp_path_factory.mktemp("explore") / "results"
    write_campaign(results, CONFIGURATION, BEST)
    partial = results / "rare_mutation/smoke/cartpole/bcm/p006_lr0.25/seeds_000-002.parquet.partial"
    partial.mkdir()
    (partial / "seed_000000.parquet").touch()
    trial = trials(CONFIGURATION, "baseline")[0]
    write_runs(results / trial.record, [run(trial.spec, "smoke", 9.0)])
    return results


def test_all_finished_records_are_found(results: Path, tmp_path: Path) -> None:
    found = find_records(results)
    assert len(found) == len(blocks(CONFIGURATION)) + 1
    assert HEBB in found
    assert not any("partial" in name for name in found)
    with pytest.raises(UserError, match="contains no record; make some with `snakemake records`"):
        find_records(tmp_path)


def test_the_table_has_a_row_for_each_run(results: Path) -> None:
    table = table_of_runs(results)
    assert table["sensitivity"].sum() == 1
    hebb = table[table["record"] == HEBB]
    assert hebb["seed"].tolist() == [0, 1, 2]
    assert hebb["best_fitness"].tolist() == [1.0, 2.0, 3.0]
    assert hebb["held_out"].tolist() == [0.0, 1.0, 2.0]
    assert set(hebb["learning_rate"]) == {0.25}
    neat = table[(table["method"] == "neat") & (table["population"] == 6) & ~table["sensitivity"]]
    assert neat["seed"].tolist() == [0, 2]
    assert neat["learning_rate"].isna().all()


def test_a_choice_changes_once_with_record_and_seed(results: Path) -> None:
    choice = RunChoice(results, HEBB, 2)
    assert choice.value == (results / HEBB, 2)
    seen: list[traitlets.Bunch] = []
    choice.observe(seen.append, "value")
    neat = "rare_mutation/smoke/cartpole/neat/p006/seeds_000-002.parquet"
    choice.record.value = neat
    choice.seed.value = 2
    assert [change.new for change in seen] == [(results / neat, 0), (results / neat, 2)]
    assert choice.seed.options == (0, 2)


def test_a_choice_begins_somewhere_if_its_record_is_not_there(results: Path) -> None:
    choice = RunChoice(results, "elsewhere.parquet", 7)
    assert choice.value == (results / find_records(results)[0], 0)


def test_an_episode_beyond_the_last_is_refused() -> None:
    player = load_player(
        RESULTS / "rare_mutation/demo/cartpole/hebb/p050_lr0.25/seeds_000-004.parquet", 0
    )
    count = len(player.held_out_seeds)
    assert episode_seed(player, 0) == player.held_out_seeds[0]
    with pytest.raises(UserError, match=f"episode {count}: the record has 0 to {count - 1}"):
        episode_seed(player, count)
