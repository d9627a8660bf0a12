"""Verdicts from runs, one rule after the other."""

from collections.abc import Mapping
from dataclasses import replace

import numpy as np
import pytest

from neol.spec.configuration import load_configuration
from neol.study.campaign.grid import Cell, cells
from neol.study.claims.answers import Answer, answers
from neol.study.claims.calibration import MadeUp, made_up_studies
from neol.study.claims.questions import load_questions

QUESTIONS = load_questions()
PAPER = next(made_up_studies("paper"))
Z = np.random.default_rng(0).permutation(np.linspace(-1.7, 1.7, 30))
"""Thirty runs whose mean is 0 and whose deviation is about 1."""
LANDER = {"bcm": (324, 4), "hebb": (323, 4), "oja": (323, 4), "neat": (312, 8), "neat_wo": (312, 9)}
"""Means and deviations close to the paper's."""
Numbers = Mapping[str, tuple[float, float]]


def study(numbers: Numbers, seeds: int = 30, task: str = "lunar_lander") -> MadeUp:
    """Return runs of a task with these moments in every cell; other methods have none."""
    drawn = {
        (cell, metric): mean + sd * np.roll(Z, place)
        for place, (method, (mean, sd)) in enumerate(numbers.items())
        for cell in PAPER.by_method[task, method]
        for metric in ("final_best", "score", "equal_evaluations")
    }
    return replace(PAPER, drawn=drawn, available=seeds)


def answer(name: str, made_up: MadeUp) -> Answer:
    (found,) = [each for each in answers(QUESTIONS, made_up) if each.question.id == name]
    return found


def verdict(name: str, numbers: Numbers, seeds: int = 30) -> str:
    return answer(name, study(LANDER | numbers, seeds)).verdict


NEAT, SPREAD = "final-neat-lunar-lander", "spread-neat-lunar-lander"


@pytest.mark.parametrize(
    ("numbers", "expected"),
    [
        ({}, "reproduced"),
        (dict.fromkeys(("bcm", "hebb", "oja"), (400, 4)), "same direction"),
        (dict.fromkeys(("bcm", "hebb", "oja"), (300, 4)), "not reproduced"),
        (dict.fromkeys(("bcm", "hebb", "oja"), (312.5, 4)), "equivalent to zero"),
        (dict.fromkeys(LANDER, (316, 40)), "inconclusive"),
        ({"bcm": (300, 2), "hebb": (345, 2), "oja": (345, 2)}, "mixed"),
    ],
)
def test_each_verdict_has_its_runs(numbers: Numbers, expected: str) -> None:
    found = answer(NEAT, study(LANDER | numbers))
    assert found.verdict == expected, found.reason


def test_an_effect_too_small_for_the_paper_s_seeds_is_not_reproduced() -> None:
    """The effect is not equivalent, compatible with the paper's 221 +- 124, but too small."""
    numbers = dict.fromkeys(("bcm", "hebb", "oja"), (2620, 1))
    made_up = study(numbers | {"neat": (2690, 790), "neat_wo": (2690, 30)}, task="hopper")
    found = answer("final-neat-hopper", made_up)
    assert found.compatible
    assert (found.verdict, found.reason) == (
        "not reproduced", "smaller than the paper's seeds could have seen",
    )  # fmt: skip


def test_the_paper_s_own_numbers_are_judged_by_the_same_rules() -> None:
    papers = {each.question.id: each.papers for each in answers(QUESTIONS, study(LANDER))}
    assert papers[NEAT] == "reproduced"
    assert papers["final-neat-hopper"] == "inconclusive"  # t = 1.8
    assert papers["spread-neat-bipedal-walker"] == "equivalent to zero"
    assert papers["continuous-standardised"] == "not reproduced"
    assert papers["whole-grid"] is None


def test_less_spread_is_lower() -> None:
    assert verdict(SPREAD, {}) == "reproduced"
    wider = dict.fromkeys(("bcm", "hebb", "oja"), (323, 16))
    assert verdict(SPREAD, wider) == "not reproduced"


@pytest.mark.parametrize(("seeds", "expected"), [(9, "not asked here"), (10, "reproduced")])
def test_a_look_takes_ten_seeds(seeds: int, expected: str) -> None:
    clear = dict.fromkeys(("bcm", "hebb", "oja"), (324, 1)) | {"neat": (312, 1)}
    found = answer(NEAT, study(LANDER | clear, seeds))
    assert (found.verdict, found.seeds) == (expected, seeds)


def test_between_two_looks_the_seeds_wait() -> None:
    assert answer(NEAT, study(LANDER, 17)).seeds == 10


def test_an_early_look_needs_more() -> None:
    noisy = dict.fromkeys(("bcm", "hebb", "oja"), (320, 12)) | {"neat": (308, 12)}
    assert verdict(NEAT, noisy, 10) == "inconclusive"
    assert verdict(NEAT, noisy, 30) == "reproduced"


def test_missing_tasks_count_in_their_family() -> None:
    """The order in which tasks are run changes no answer."""
    found = answer(NEAT, study(LANDER))
    assert found.p_holm == pytest.approx(6 * found.p)
    assert answer("final-neat-hopper", study(LANDER)).verdict == "not asked here"


def test_runs_that_cannot_answer_count_in_their_family_as_missing() -> None:
    """Short runs of another task have an effect, but it makes no other question's p smaller."""
    made_up = study(LANDER)
    far = dict.fromkeys(("bcm", "hebb", "oja"), (900, 1)) | {"neat": (100, 1), "neat_wo": (100, 1)}
    generations = {"cartpole": 500, "lunar_lander": 500, "hopper": 60, "bipedal_walker": 500}
    there = replace(
        made_up,
        drawn={**made_up.drawn, **study(far, task="hopper").drawn},
        budget=PAPER.budget.model_copy(update={"generations": generations}),
    )
    short = answer("final-neat-hopper", there)
    assert short.verdict == "too short" and short.whole and short.whole.low > 0
    assert np.isnan(short.p_holm)
    assert answer(NEAT, there).p_holm == pytest.approx(6 * answer(NEAT, there).p)


def test_a_rule_that_is_surely_lower_makes_competitive_mixed() -> None:
    drawn = dict(PAPER.drawn)
    for cell in PAPER.by_method["lunar_lander", "bcm"]:
        drawn[cell, "final_best"] = 305 + Z
    found = answer("competitive", replace(PAPER, drawn=drawn))
    assert (found.verdict, found.counts["against"]) == ("mixed", 1)


def test_rules_with_one_cell_and_with_several_are_averaged_over_the_same_seeds() -> None:
    """By Tables 3 and 4 Hebb has two cells on Bipedal Walker, the other rules have one."""
    tables = load_configuration("paper", ["budget.configurations=tables"])
    by_method: dict[tuple[str, str], list[Cell]] = {}
    for cell in cells(tables):
        by_method.setdefault((cell.task, cell.method), []).append(cell)
    found = answer("best-cells", replace(PAPER, by_method=by_method))
    assert found.verdict == "not asked here"
    assert found.whole and found.whole.evidence.ours


def test_short_runs_decide_nothing_but_that_a_ceiling_is_reached() -> None:
    short = PAPER.budget.model_copy(update={"generations": 100})
    there = replace(study(dict.fromkeys(LANDER, (500, 0)), task="cartpole"), budget=short)
    assert answer("cartpole-ceiling", there).verdict == "reproduced"
    assert answer("cartpole-score-neat", there).verdict == "too short"
    below = replace(study(dict.fromkeys(LANDER, (450, 1)), task="cartpole"), budget=short)
    assert answer("cartpole-ceiling", below).verdict == "too short"
    assert (
        answer("cartpole-ceiling", replace(below, budget=PAPER.budget)).verdict == "not reproduced"
    )


def test_no_difference_at_all_is_no_contradiction() -> None:
    """[0, 0] is inside every margin."""
    flat = study(dict.fromkeys(LANDER, (0.75, 0)), task="cartpole")
    found = answer("cartpole-score-neat", flat)
    assert (found.verdict, found.whole and (found.whole.low, found.whole.high)) == (
        "reproduced", (0, 0),
    )  # fmt: skip


def test_a_large_p_value_is_no_equality() -> None:
    noisy = study(dict.fromkeys(LANDER, (0.745, 0.05)), task="cartpole")
    assert answer("cartpole-score-neat", noisy).verdict == "inconclusive"


def test_printed_means_that_are_surely_others_are_found() -> None:
    """0.7498 with a deviation of 0.0003 is not 0.744 with one of 0.011."""
    parts = answer("printed", study(dict.fromkeys(LANDER, (0.7498, 0.0003)), task="cartpole")).parts
    states = {part.evidence.label: part.state for part in parts if part.state}
    assert states["cartpole: SCORE of neat"] == "against"


def test_what_holds_by_construction_says_so() -> None:
    assert answer("larger-populations-score", PAPER).verdict == "holds by construction"


def test_the_two_by_two_is_a_difference_of_differences() -> None:
    """A rule adds 12 without weight mutation and 2 with it."""
    constants = load_configuration("two_by_two")
    made_up = study(LANDER | {"neat": (322, 4)})
    cells = {
        each: Cell("lunar_lander", each, 300, rate)
        for each, rate in (
            ("bcm_mutated", 0.25),
            ("hebb_mutated", 0.00025),
            ("oja_mutated", 0.0025),
        )
    }
    assert set(cells) <= set(constants.budget.methods)
    drawn = dict(made_up.drawn)
    drawn |= {
        (cell, name): 324 + 4 * Z for cell in cells.values() for name in ("final_best", "score")
    }
    there = replace(made_up, drawn=drawn, cells=(*made_up.cells, *cells.values()))
    found = answer("two-by-two", there)
    assert found.whole is not None and found.whole.evidence.ours is not None
    assert found.whole.evidence.ours.value < 0
    assert found.verdict == "not reproduced"
    assert answer("two-by-two", made_up).verdict == "not asked here"


def test_cells_in_which_nothing_moves_are_no_success_of_a_rule() -> None:
    made_up = study(LANDER)
    rules = {cell for cell in made_up.cells if cell.learning_rate is not None}
    found = answer(NEAT, replace(made_up, near_control=frozenset(rules)))
    assert found.near_control and found.verdict == "reproduced"
    hebb = frozenset(cell for cell in rules if cell.method == "hebb")
    found = answer(NEAT, replace(made_up, near_control=hebb))
    assert not found.near_control
    assert [part.near_control for part in found.parts] == [False, True, False]


def test_fresh_seeds_are_reported_separately() -> None:
    found = answer(NEAT, study(LANDER))
    assert found.fresh is not None and found.fresh.degrees < 30
    assert answer(NEAT, study(LANDER, 10)).fresh is None


def test_seeds_needed_follow_from_the_paper_s_effect() -> None:
    """When n is 30 (2.8 e / 12)^2, 2.8 of our errors are the paper's effect of 12.0."""
    found = answer(NEAT, study(LANDER))
    assert found.whole is not None and found.whole.evidence.ours is not None
    error = found.whole.evidence.ours.error
    assert found.seeds_needed == np.ceil(30 * (2.8016 * error / 11.97) ** 2)
