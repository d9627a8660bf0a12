"""Captions, marks and numbers of figures; their look was judged by eye."""

from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd
import pytest
from matplotlib.figure import Figure
from matplotlib.patches import Rectangle
from scipy import stats

from neol.pictures.style import STYLES, save
from neol.spec.configuration import ROOT, load_configuration
from neol.spec.readings import DEFAULT_READING
from neol.study.campaign.grid import RESULTS
from neol.study.campaign.shown import select
from neol.study.figures.convergence import convergence
from neol.study.figures.heatmaps import heatmaps
from neol.study.figures.paper_figures import figure2, figure3, heatmap, heatmaps_of
from neol.study.outcomes.campaign_runs import Campaign
from tests.helpers.made_up import configuration

METHODS = ("bcm", "neat")


def curves(generations: int = 4, seeds: int = 3) -> pd.DataFrame:
    """Seed s of BCM ends at generations + s, of NEAT at s."""
    return pd.DataFrame(
        [
            ("hopper", method, seed, generation, seed + generation * (method == "bcm"))
            for method in METHODS
            for seed in range(seeds)
            for generation in range(1, generations + 1)
        ],
        columns=["task", "method", "seed", "generation", "best_fitness"],
    )


def runs() -> pd.DataFrame:
    """Means 10 * population at the lower rate, 20 * population at the higher, 1.5 for NEAT."""
    rows = [
        ("bcm", population, rate, seed, factor * population + seed - 1)
        for population in (6, 12)
        for rate, factor in ((0.1, 10), (0.2, 20))
        for seed in range(3)
    ]
    rows += [("neat", population, np.nan, seed, 1.5) for population in (6, 12) for seed in range(3)]
    return pd.DataFrame(rows, columns=["method", "population", "learning_rate", "seed", "value"])


def draw_curves(
    table: pd.DataFrame, incomplete: Mapping[tuple[str, str], str] | None = None, **more: Any
) -> Figure:
    return convergence(
        table,
        tasks=["hopper"],
        methods=METHODS,
        seeds={"hopper": 3},
        note="Budget made up.",
        incomplete=incomplete or {},
        **more,
    )


def cells_of(table: pd.DataFrame) -> pd.DataFrame:
    """A row for each cell of such runs."""
    keys = ["method", "population", "learning_rate"]
    columns = {"seeds": "size", "mean": "mean", "standard_error": "sem"}
    cells = table.groupby(keys, dropna=False)["value"].agg(**columns).reset_index()
    return cells.assign(near_control=cells["learning_rate"] == 0.1, near_best=cells["mean"] > 100)


def draw_heatmaps(table: pd.DataFrame) -> Figure:
    return heatmaps(
        cells_of(table),
        title="Hopper",
        methods=METHODS,
        populations=[6, 12],
        learning_rates=[0.1, 0.2],
        seeds=3,
        note="Budget made up.",
    )


def texts(figure: Figure, axis: int) -> list[str]:
    return [text.get_text() for text in figure.axes[axis].texts]


def footer(figure: Figure) -> str:
    return figure.get_supxlabel().replace("\n", " ")


def frames(figure: Figure, axis: int) -> list[Rectangle]:
    patches = figure.axes[axis].patches
    return [each for each in patches if isinstance(each, Rectangle) and not each.get_hatch()]


def hatched(figure: Figure, axis: int) -> int:
    return sum(bool(patch.get_hatch()) for patch in figure.axes[axis].patches)


def test_lines_are_means_over_seeds() -> None:
    top = draw_curves(curves()).axes[0]
    bcm, neat = top.lines
    assert bcm.get_xdata().tolist() == [1, 2, 3, 4]
    assert bcm.get_ydata().tolist() == [2, 3, 4, 5]
    assert neat.get_ydata().tolist() == [1, 1, 1, 1]
    assert (bcm.get_color(), neat.get_color()) == (STYLES["bcm"].colour, STYLES["neat"].colour)


def test_bands_end_at_the_range_of_the_runs() -> None:
    low, high = draw_curves(curves(generations=1)).axes[0].get_ylim()  # BCM 1, 2, 3, NEAT 0, 1, 2
    assert (low, high) == pytest.approx((-0.09, 3.09))


def test_no_band_goes_beyond_the_runs() -> None:
    """A mean's interval must not be drawn above a task's maximum."""
    for band in draw_curves(curves(seeds=3)).axes[0].collections:
        heights = band.get_paths()[0].vertices[:, 1]
        assert heights.min() >= 0
        assert heights.max() <= 6


def test_only_lines_that_are_there_have_labels() -> None:
    figure = draw_curves(curves().query("method == 'bcm'"))
    (legend,) = figure.legends
    assert [text.get_text() for text in legend.get_texts()] == ["BCM"]


def test_every_seed_is_a_dot() -> None:
    dots = draw_curves(curves()).axes[1].collections
    assert sorted(dots[0].get_offsets()[:, 1]) == [4, 5, 6]


def test_curves_that_lack_seeds_are_marked() -> None:
    table = curves()
    figure = draw_curves(table[(table["method"] == "neat") | (table["seed"] > 0)])
    assert "* BCM on Hopper: 2 of 3 seeds." in footer(figure)
    assert [tick.get_text() for tick in figure.axes[1].get_xticklabels()] == ["BCM*", "NEAT"]
    whole = draw_curves(table)
    assert "*" not in footer(whole)
    assert "Budget made up." in footer(whole)


def test_a_choice_among_fewer_cells_is_marked() -> None:
    figure = draw_curves(curves(), {("hopper", "bcm"): "chosen among 3 of 4"})
    assert "* BCM on Hopper: chosen among 3 of 4." in footer(figure)
    assert [tick.get_text() for tick in figure.axes[1].get_xticklabels()] == ["BCM*", "NEAT"]


def test_a_method_without_runs_is_said() -> None:
    figure = draw_curves(curves().query("method == 'bcm'"))
    assert texts(figure, 1) == ["no runs"]
    assert "NEAT on Hopper: 0 of 3 seeds" in footer(figure)


def test_a_run_that_ended_early_keeps_its_last_value_in_the_boxplot() -> None:
    table = curves().query("not (method == 'bcm' and seed == 2 and generation > 2)")
    figure = draw_curves(table)
    assert sorted(figure.axes[1].collections[0].get_offsets()[:, 1]) == [4, 4, 5]
    assert figure.axes[0].lines[0].get_xdata().tolist() == [1, 2]  # as far as all seeds go


def test_cells_print_means_with_the_lowest_rate_at_the_bottom() -> None:
    figure = draw_heatmaps(runs())
    assert texts(figure, 0)[::2] == ["60.0†", "120†", "120", "240"]
    assert texts(figure, 0)[1::2] == ["±0.58"] * 4
    assert texts(figure, 1) == ["no learning rate", *["1.50", "±0"] * 2]
    assert "† near control" in footer(figure)
    assert figure.axes[0].get_ylim() == (0, 2)
    assert [text.get_text() for text in figure.axes[0].get_yticklabels()] == ["0.1", "0.2"]


def test_small_means_keep_three_significant_figures() -> None:
    table = runs().query("method == 'bcm'")
    figure = draw_heatmaps(table.assign(value=table["value"] / 10000))
    assert texts(figure, 0)[::2] == ["0.00600†", "0.0120†", "0.0120", "0.0240"]


def test_levels_are_drawn_or_named_where_they_lie_beyond() -> None:
    levels = {"hopper": {"threshold": (3800.0, 3800.0), "paper": (2.0, 5.0)}}
    bottom = draw_curves(curves(), levels=levels).axes[1]
    assert bottom.get_title() == "↑ threshold 3800\npaper 2.00 to 5.00"
    (band,) = [each for each in bottom.patches if isinstance(each, Rectangle)]
    assert (band.get_y(), band.get_height()) == (2, 3)


def test_curves_near_control_are_marked() -> None:
    figure = draw_curves(curves(), near_control={("hopper", "bcm")})
    assert [tick.get_text() for tick in figure.axes[1].get_xticklabels()] == ["BCM†", "NEAT"]
    assert "† near control" in footer(figure)
    assert "†" not in footer(draw_curves(curves()))


def test_numbers_of_a_convergence_are_written_in_full(tmp_path: Path) -> None:
    """Plain pandas on shipped records says the same of every generation."""
    campaign = Campaign(select("demo"), ROOT / RESULTS)
    figure2(campaign).write(tmp_path)
    table = pd.read_csv(tmp_path / "figure2.csv")
    neat = table[(table["task"] == "lunar_lander") & (table["method"] == "neat")]
    folder = ROOT / RESULTS / DEFAULT_READING / "demo" / "lunar_lander" / "neat" / "p050"
    rows = pd.concat(map(pd.read_parquet, folder.glob("*.parquet")))
    by_generation = rows.groupby("generation")["best_fitness"]
    lines = neat[neat["shown"] == "line"].set_index("generation")
    assert lines["value"].tolist() == pytest.approx(by_generation.mean().tolist(), rel=1e-12)
    half = stats.t.ppf(0.975, 9) * by_generation.sem()
    assert (lines["high"] - lines["value"]).tolist() == pytest.approx(half.tolist(), abs=1e-9)
    finals = neat[neat["shown"] == "final"].set_index("seed")["value"].sort_index()
    last = rows[rows["generation"] == 60].set_index("seed")["best_fitness"].sort_index()
    assert finals.tolist() == last.tolist()


def test_numbers_of_a_heatmap_are_written_in_full(tmp_path: Path) -> None:
    """Means, standard errors and the set near the best, in plain pandas and SciPy."""
    campaign = Campaign(select("evidence", "lunar_lander"), ROOT / RESULTS)
    heatmap(5, campaign).write(tmp_path)
    table = pd.read_csv(tmp_path / "figure5.csv")
    assert len(table) == 3 * 4 + 1
    hebb = table[table["method"] == "hebb"]
    runs = {}
    for row in hebb.itertuples():
        name = f"p300_lr{row.learning_rate:.5f}".rstrip("0")
        folder = ROOT / RESULTS / DEFAULT_READING / "paper" / "lunar_lander" / "hebb" / name
        rows = pd.concat(map(pd.read_parquet, folder.glob("*.parquet")))
        runs[row.Index] = rows[rows["generation"] == 500]["best_fitness"].to_numpy()
    for row in hebb.itertuples():
        own = runs[row.Index]
        assert (row.mean, row.standard_error) == pytest.approx((own.mean(), stats.sem(own)))
        p = [
            stats.ttest_ind(other, own, equal_var=False, alternative="greater").pvalue
            for place, other in runs.items()
            if place != row.Index
        ]
        assert row.near_best == (min(p) >= 0.05 / 3)
    assert 0 < hebb["near_best"].mean() < 1


def test_a_heatmap_says_its_own_steps_and_what_score_rewards(tmp_path: Path) -> None:
    campaign = Campaign(configuration(tasks=("cartpole", "hopper")), tmp_path)
    assert "of at most 200 steps" in footer(heatmap(4, campaign).figure)
    assert "by construction" not in footer(heatmap(4, campaign).figure)
    assert "SCORE grows with the population by construction" in footer(heatmap(8, campaign).figure)


def test_figure_3_says_where_its_colours_are_not_the_papers(tmp_path: Path) -> None:
    assert "NEAT (w/o) is purple" in footer(figure3(Campaign(configuration(), tmp_path)).figure)


def test_a_budget_has_the_heat_maps_of_its_tasks() -> None:
    assert heatmaps_of(configuration(tasks=("cartpole", "hopper")).budget) == [4, 6, 8, 10]
    assert heatmaps_of(load_configuration("evidence").budget) == [4, 5, 8, 9]


def test_panels_share_a_scale() -> None:
    bcm, neat = (axis.collections[0].get_clim() for axis in draw_heatmaps(runs()).axes[:2])
    assert bcm == neat == (1.5, 240)


def test_a_method_without_learning_rate_stands_between_the_rates() -> None:
    bcm, neat = draw_heatmaps(runs()).axes[:2]
    assert bcm.get_ylim() == (0, 2)
    assert neat.get_ylim() == (-0.5, 1.5)  # its row is from 0 to 1


def test_small_standard_errors_have_a_short_exponent() -> None:
    table = runs().assign(value=lambda rows: rows["seed"] * 7.1e-5)
    assert texts(draw_heatmaps(table), 0)[1::2] == ["±4.1e−5"] * 4


def test_the_single_highest_cell_is_framed_and_thinly_those_near_it() -> None:
    figure = draw_heatmaps(runs())
    places = {(round(each.get_x()), round(each.get_y())) for each in frames(figure, 0)}
    thick = [each for each in frames(figure, 0) if each.get_linewidth() > 1]
    assert [(round(each.get_x()), round(each.get_y())) for each in thick] == [(1, 1)]
    assert places == {(1, 0), (0, 1), (1, 1)}  # 60 is not near the best
    assert not frames(figure, 1)  # a tie


def test_cells_that_lack_seeds_are_hatched_and_counted() -> None:
    table = runs().query("not (population == 6 and learning_rate == 0.1 and seed > 0)")
    table = table.query("not (population == 12 and learning_rate == 0.2)")
    figure = draw_heatmaps(table)
    assert texts(figure, 0)[::2] == ["59.0†", "120†", "120", "no runs"]
    assert texts(figure, 0)[1::2] == ["1/3", "±0.58", "±0.58", ""]
    assert hatched(figure, 0) == 2
    hatches = [patch for patch in figure.axes[0].patches if patch.get_hatch()]
    assert all(patch.get_alpha() is None and patch.get_linewidth() > 0 for patch in hatches)
    assert "Hatched: 2 of 6 cells lack seeds." in footer(figure)


@pytest.mark.slow
@pytest.mark.parametrize("table", [runs().assign(value=500.0), runs().iloc[:0]])
def test_degenerate_heatmaps_can_be_drawn(table: pd.DataFrame, tmp_path: Path) -> None:
    save(draw_heatmaps(table), tmp_path / "figure4")


@pytest.mark.slow
def test_files_repeat_byte_for_byte(tmp_path: Path) -> None:
    for name in ("first", "second"):
        save(draw_curves(curves()), tmp_path / name)
    for suffix in ("pdf", "png"):
        first, second = (tmp_path / f"{name}.{suffix}" for name in ("first", "second"))
        assert first.read_bytes() == second.read_bytes()
        assert b"matplotlib.org" not in first.read_bytes()
