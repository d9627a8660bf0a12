"""A rule that the paper does not have finds its place in every table and figure."""

from collections.abc import Iterator
from pathlib import Path

import pytest

from neol.network.rules import RULES, rule
from neol.pictures.style import STYLES, save, styles
from neol.spec.configuration import load_configuration
from neol.study.campaign.grid import Cell
from neol.study.campaign.methods import shown_methods
from neol.study.figures import effect_figures, effect_sizes
from neol.study.figures.paper_figures import figure2, figure3, heatmap
from neol.study.outcomes import effects
from neol.study.outcomes.campaign_runs import Campaign
from neol.study.outcomes.chosen_cells import SETTINGS
from neol.study.outcomes.outcomes import gather
from neol.study.tables.paper_tables import table1, table4, table6, table8
from tests.helpers.made_up import write_campaign

CELL = Cell("cartpole", "leaky", 12, 0.25)


def leaky(x: float, y: float, w: float, theta: float) -> float:
    """Hebb's rule, leaking."""
    return x * y - 0.1 * w


@pytest.fixture
def campaign(tmp_path: Path) -> Iterator[Campaign]:
    rule(leaky)
    constants = load_configuration(
        "smoke",
        [
            "budget.methods=[neat, leaky, bcm, hebb, oja, neat_wo]",
            "budget.tasks=[cartpole]",
            "budget.generations=2",
            "evaluation.held_out_episodes=1",
        ],
    )
    write_campaign(tmp_path, constants, {CELL: [7.0, 8.0, 9.0]})
    yield Campaign(constants, tmp_path)
    del RULES["leaky"]


def test_tables_have_a_column_before_neat(campaign: Campaign) -> None:
    assert table1(campaign).columns == ("BCM", "Hebb", "Oja", "leaky", "NEAT")
    assert table8(campaign).columns[-2:] == ("leaky", "NEAT (w/o)")
    assert table6(campaign).columns[-1] == "leaky vs NEAT"
    texts = [line.entries[3].text for line in table1(campaign).lines]
    assert texts[:2] == ["8.00 ± 1.00", "--"]
    assert table4(campaign).lines[0].entries[3].text == "pop=12, lr=0.25"


@pytest.mark.slow
def test_figures_draw_it(campaign: Campaign, tmp_path: Path) -> None:
    budget, outcomes = campaign.configuration.budget, gather(campaign)
    titles = [axis.get_title() for axis in heatmap(4, campaign).figure.axes]
    assert titles[:5] == ["BCM", "Hebb", "Oja", "leaky", "NEAT"]
    for drawing in (figure2(campaign), figure3(campaign)):
        (legend,) = drawing.figure.legends
        assert "leaky" in [text.get_text() for text in legend.texts]
    sizes = effects.effect_sizes(outcomes, budget)
    assert set(sizes.loc[sizes["method"] == "leaky", "a12"]) == {1.0}
    figures = [
        effect_sizes.draw_effect_sizes(sizes, budget, "note"),
        effect_figures.draw_aggregates(effects.aggregates(outcomes, budget), budget, "note"),
        effect_figures.draw_profiles(effects.profiles(outcomes, budget), budget, "note"),
        effect_figures.draw_efficiency(effects.efficiency(outcomes), budget, "note"),
        effect_figures.draw_selection_bias(effects.selection_bias(outcomes), budget, "note"),
    ]
    for number, figure in enumerate(figures):
        save(figure, tmp_path / str(number))
    assert SETTINGS["table4"].methods(budget) == ("bcm", "hebb", "oja", "leaky", "neat_wo")
    assert shown_methods(budget)[-3:] == ("leaky", "neat", "neat_wo")


def test_the_papers_methods_keep_their_looks_and_others_have_their_own() -> None:
    further = [f"rule_{number}" for number in range(60)]
    looks = styles(["bcm", *further, "neat"])
    assert (looks["bcm"], looks["neat"]) == (STYLES["bcm"], STYLES["neat"])
    assert len(set(looks.values())) == 62
    assert len({looks[name].colour for name in further[:4]}) == 4
