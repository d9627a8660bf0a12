"""The meaning of returns in words."""

import pandas as pd
import pytest

from neol.study.report.levels import LEVELS, describe_level, levels_reached


@pytest.mark.parametrize(
    ("task", "returns", "words"),
    [
        ("hopper", 1012.0, "the hopper stands still, which pays 1 for each of 1,000 steps"),
        ("hopper", 2900.0, "the hopper hops"),
        ("lunar_lander", -150.0, "the lander crashes"),
        ("lunar_lander", 200.0, "the lander lands"),
        ("bipedal_walker", 183.0, "the walker walks part of the way"),
        ("acrobot", -100.0, ""),
    ],
)
def test_a_return_is_named(task: str, returns: float, words: str) -> None:
    assert describe_level(task, returns) == words


def test_levels_ascend() -> None:
    for levels in LEVELS.values():
        assert [each.at_least for each in levels] == sorted(each.at_least for each in levels)


def test_the_levels_of_each_task_are_told_once() -> None:
    columns = ["task", "held_out", "final_best"]
    rows = [
        ("lunar_lander", -170.0, 90.0), ("lunar_lander", -100.0, 260.0),
        ("hopper", 700.0, 1000.0), ("hopper", 1000.0, 1000.0),
        ("acrobot", -90.0, -80.0), ("cartpole", float("nan"), 500.0),
    ]  # fmt: skip
    assert levels_reached(pd.DataFrame(rows, columns=columns)) == [
        "Lunar Lander: champions return -170 to -100 in fresh episodes (the lander crashes); their "
        "final best fitness was 90 to 260. Gymnasium calls a mean of 200 solved.",
        "Hopper: champions return 700 to 1,000 in fresh episodes (between “the hopper falls” and "
        "“the hopper stands still, which pays 1 for each of 1,000 steps”); their final best "
        "fitness was 1,000. Gymnasium calls a mean of 3,800 solved.",
        "Acrobot: champions return -90 in fresh episodes; their final best fitness was -80.",
    ]
