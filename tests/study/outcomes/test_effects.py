"""Analyses beyond the paper's, by hand and on degenerate runs."""

import math
from pathlib import Path

import numpy as np
import pandas as pd
import pytest
from scipy import stats

from neol.pictures.style import save
from neol.spec.configuration import ROOT
from neol.spec.readings import DEFAULT_READING
from neol.study.campaign.grid import RESULTS, Cell, cells
from neol.study.campaign.shown import select
from neol.study.figures import effect_figures, effect_sizes
from neol.study.outcomes import effects
from neol.study.outcomes.campaign_runs import Campaign
from neol.study.outcomes.outcomes import Outcomes, gather
from neol.study.outcomes.statistics import mean_interval
from tests.helpers.made_up import configuration, write_campaign

pytestmark = pytest.mark.slow

TASKS = ("cartpole", "hopper")
BCM = {task: Cell(task, "bcm", 12, 0.0025) for task in TASKS}


CONSTANTS = configuration(tasks=TASKS)
BUDGET = CONSTANTS.budget


def collected(folder: Path, values: dict[Cell, list[float | None]]) -> Outcomes:
    write_campaign(folder, CONSTANTS, values)
    return gather(Campaign(CONSTANTS, folder))


def row(table: pd.DataFrame, **place: object) -> pd.Series:
    for key, value in place.items():
        table = table[table[key] == value]
    assert len(table) == 1
    return table.iloc[0]


def test_effects_by_hand(tmp_path: Path) -> None:
    """BCM wins every pair on CartPole; on Hopper -1, 0, 4 wins 1 + 1/2 x 1 of 3 against 0, 0, 0.

    Both means are 6 and 1 above NEAT's 0, with standard errors 1 / sqrt 3 and sqrt(7 / 3).
    """
    values = {BCM["cartpole"]: [5.0, 6.0, 7.0], BCM["hopper"]: [-1.0, 0.0, 4.0]}
    table = effects.effect_sizes(collected(tmp_path, values), BUDGET)
    place = {"outcome": "final fitness", "against": "neat", "method": "bcm"}
    cartpole = row(table, **place, task="cartpole")
    assert (cartpole["a12"], cartpole["a12_low"], cartpole["a12_high"]) == (1, 1, 1)
    reach = stats.t.ppf(0.975, 2) / math.sqrt(3)
    assert (cartpole["difference"], cartpole["high"]) == pytest.approx((6, 6 + reach))
    assert row(table, **place, task="hopper")["difference"] == 1
    assert row(table, **place, task="hopper")["a12"] == 0.5
    assert row(table, **place, task="all")["a12"] == 0.75
    assert row(table, **place, task="hopper")["paper_a12"] == 663 / 900
    assert row(table, **place, task="hopper")["paper_difference"] == pytest.approx(303.6)
    assert len(table) == 6 * 3 * 3 + 3 * 3  # comparisons, rules, tasks and all; and NEAT (w/o)
    family = table.dropna(subset="p_holm")
    assert len(family) == 4 * 3 * 2
    assert (family["p_holm"] >= family["p"]).all()
    best = family["p"].min()
    assert family["p_holm"].min() == pytest.approx(min(1, 24 * best))


def test_one_task_is_not_all_tasks_together(tmp_path: Path) -> None:
    constants = configuration(tasks=("hopper",))
    write_campaign(tmp_path, constants, {})
    outcomes = gather(Campaign(constants, tmp_path))
    assert set(effects.effect_sizes(outcomes, constants.budget)["task"]) == {"hopper"}
    assert set(effects.aggregates(outcomes, constants.budget)["task"]) == {"hopper"}


def test_pairs_show_what_independent_samples_hide(tmp_path: Path) -> None:
    """BCM is one above NEAT at every seed, whose values differ by 100."""
    neat = {Cell("hopper", "neat", p, None): [0.0, 100.0, 200.0] for p in (6, 12)}
    values = neat | {BCM["hopper"]: [1.0, 101.0, 201.5]}
    table = effects.effect_sizes(collected(tmp_path, values), BUDGET)
    found = row(table, outcome="final fitness", against="neat", method="bcm", task="hopper")
    assert found["low"] < 0 < found["paired_low"]
    assert found["correlation"] == pytest.approx(1, abs=1e-4)


def test_effects_of_shipped_records_a_second_time() -> None:
    """Every difference, interval and p-value of `demo`, in plain pandas and SciPy."""
    constants = select("demo")
    outcomes = gather(Campaign(constants, ROOT / RESULTS))
    table = effects.effect_sizes(outcomes, constants.budget)
    folder = ROOT / RESULTS / DEFAULT_READING / "demo"

    def final(task: str, method: str) -> pd.Series:
        means = {}
        for cell in (folder / task / method).iterdir():
            rows = pd.concat(map(pd.read_parquet, cell.glob("*.parquet")))
            last = rows[rows["generation"] == rows["generation"].max()]
            means[cell] = last.set_index("seed")["best_fitness"].sort_index()
        return max(means.values(), key=lambda runs: runs.mean())

    compared = 0
    for task in ("cartpole", "lunar_lander"):
        neat = final(task, "neat")
        for method in ("bcm", "hebb", "oja", "neat_wo"):
            rule = final(task, method)
            if rule.mean() == neat.mean() or task == "cartpole":
                continue  # of equal means the smaller rate is chosen, which is tested elsewhere
            found = row(table, outcome="final fitness", against="neat", method=method, task=task)
            welch = stats.ttest_ind(rule, neat, equal_var=False)
            pairs = stats.ttest_rel(rule, neat)
            interval, by_pairs = welch.confidence_interval(), pairs.confidence_interval()
            assert [found["difference"], found["low"], found["high"], found["p"]] == pytest.approx(
                [rule.mean() - neat.mean(), *interval, welch.pvalue]
            )
            assert [found["paired_low"], found["paired_high"]] == pytest.approx([*by_pairs])
            ranks = stats.mannwhitneyu(rule, neat, alternative="two-sided").pvalue
            assert found["p_rank_sum"] == pytest.approx(ranks)
            compared += 1
    assert compared == 4


def test_neat_without_mutation_is_compared_in_its_own_cell(tmp_path: Path) -> None:
    """It beats NEAT by every outcome, but its tests belong to no family."""
    values = {Cell(task, "neat_wo", p, None): [9.0] * 3 for task in TASKS for p in (6, 12)}
    table = effects.effect_sizes(collected(tmp_path, values), BUDGET)
    for outcome in ("final fitness", "SCORE", "held-out return"):
        place = {"outcome": outcome, "task": "hopper"}
        ours = row(table, **place, against="neat", method="neat_wo")
        assert ours["a12"] == 1
        assert ours["p_rank_sum"] < 0.1
        assert math.isnan(ours["p_holm"])
        assert row(table, **place, against="neat_wo", method="bcm")["a12"] == 0


def test_aggregates_by_hand(tmp_path: Path) -> None:
    """475 on CartPole and 3800 on Hopper are 1."""
    values = {BCM["cartpole"]: [475.0] * 3, BCM["hopper"]: [3800.0] * 3}
    table = effects.aggregates(collected(tmp_path, values), BUDGET)
    assert row(table, method="bcm", task="all")["iqm"] == 1
    assert row(table, method="neat", task="hopper")["iqm"] == 0


def test_profiles_fall_from_one_to_nothing(tmp_path: Path) -> None:
    values = {BCM["cartpole"]: [475.0] * 3, BCM["hopper"]: [3800.0, 3800.0, 0.0]}
    table = effects.profiles(collected(tmp_path, values), BUDGET)
    shares = table[table["method"] == "bcm"].set_index("threshold")["share"]
    assert shares.is_monotonic_decreasing
    assert shares.to_dict() == pytest.approx({-0.05: 1, 0: 5 / 6, 1: 0})


def test_selection_is_what_the_training_maximum_flatters(tmp_path: Path) -> None:
    """The made-up champions return 1 less in fresh episodes."""
    table = effects.selection_bias(collected(tmp_path, {}))
    assert set(table["mean"]) == {1.0}
    assert set(table["seeds"]) == {3}
    assert set(table["without_value"]) == {0}


def test_a_seed_counts_once_however_many_learning_rates_it_has(tmp_path: Path) -> None:
    """Values by seed over the two rates are 0, 3 and 6; SCORE is 12 / 16,000 x (2 x final + 1)."""
    values = {BCM["hopper"]: [0.0, 6.0, 12.0]}
    outcomes = collected(tmp_path, values)
    place = {"metric": "score", "task": "hopper", "method": "bcm", "population": 12}
    table = effects.efficiency(outcomes)
    low, high = mean_interval(np.array([0.0, 3.0, 6.0]))
    found = row(table, **place)
    assert found["seeds"] == 3
    assert found["high"] - found["low"] == pytest.approx(24 / 16_000 * float(high - low))
    outcomes.runs.loc[0, "held_out"] = math.nan
    gaps = effects.selection_bias(outcomes)
    assert (gaps["seeds"].tolist(), gaps["without_value"].sum()) == ([3] * len(gaps), 1)


def test_methods_of_one_population_share_nearly_their_whole_runs(tmp_path: Path) -> None:
    """Two generations of 6 or 12: 6 to 12 evaluations, or 12 to 24; all have 12 to 12 alone."""
    table = effects.efficiency(collected(tmp_path, {}))
    place = {"metric": "equal_evaluations", "task": "hopper", "method": "neat"}
    for size in (6, 12):
        found = row(table, **place, compared="population", population=size)
        assert (found["first"], found["last"], found["mean"]) == (size, 2 * size, 1)
        assert math.isnan(row(table, **place, compared="populations", population=size)["mean"])


def test_score_grows_with_the_population_where_efficiency_does_not(tmp_path: Path) -> None:
    table = effects.efficiency(collected(tmp_path, {}))
    score = table[(table["metric"] == "score") & (table["method"] == "neat")]
    by_population = score[score["task"] == "hopper"].set_index("population")["mean"]
    assert by_population[12] == pytest.approx(2 * by_population[6])
    genome = table[(table["metric"] == "score_per_genome") & (table["method"] == "neat")]
    by_genome = genome[genome["task"] == "hopper"].set_index("population")["mean"]
    assert by_genome[12] == pytest.approx(by_genome[6]) == pytest.approx(by_population[6] / 6)


@pytest.mark.parametrize("runs", ["none", "one", "all equal"])
def test_degenerate_runs_can_be_drawn(runs: str, tmp_path: Path) -> None:
    seeds = {"none": [None] * 3, "one": [1.0, None, None], "all equal": [1.0] * 3}[runs]
    outcomes = collected(tmp_path, dict.fromkeys(cells(CONSTANTS), seeds))
    sizes = effects.effect_sizes(outcomes, BUDGET)
    figures = [
        effect_sizes.draw_effect_sizes(sizes, BUDGET, "note"),
        effect_figures.draw_aggregates(effects.aggregates(outcomes, BUDGET), BUDGET, "note"),
        effect_figures.draw_profiles(effects.profiles(outcomes, BUDGET), BUDGET, "note"),
        effect_figures.draw_efficiency(effects.efficiency(outcomes), BUDGET, "note"),
        effect_figures.draw_selection_bias(effects.selection_bias(outcomes), BUDGET, "note"),
    ]
    for number, figure in enumerate(figures):
        save(figure, tmp_path / str(number))
    if runs == "none":
        assert sizes[["a12", "difference", "p"]].isna().all(axis=None)
