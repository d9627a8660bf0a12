"""Records side by side."""

import dataclasses
from pathlib import Path

import numpy as np
import pytest
from scipy import stats

from neol.base.errors import UserError
from neol.run.record_file import read_record, write_record
from neol.spec.configuration import load_configuration
from neol.spec.readings import DEFAULT_READING
from neol.study.campaign.grid import cells
from neol.study.figures.side_by_side import (
    differing_constants,
    learning_curves,
    outcome_rows,
    read_compared,
)
from neol.study.outcomes.score import samples, score
from tests.helpers.made_up import configuration, run, write_campaign

FINAL = {"bcm": [10.0, 20.0, 60.0], "neat": [1.0, 2.0, 6.0]}


def written(tmp_path: Path, generations: int) -> list[Path]:
    """Folders of BCM and NEAT on CartPole, P = 6, with a block of three seeds."""
    smoke = configuration(generations=generations)
    chosen = {
        method: next(
            cell for cell in cells(smoke) if cell.method == method and cell.population == 6
        )
        for method in FINAL
    }
    write_campaign(tmp_path, smoke, {chosen[method]: FINAL[method] for method in FINAL})
    return [
        next((tmp_path / DEFAULT_READING / "smoke").rglob(f"{method}/p006*")) for method in FINAL
    ]


@pytest.fixture
def paths(tmp_path: Path) -> list[Path]:
    return written(tmp_path, generations=2)


def test_outcomes_are_means_over_seeds_with_intervals(paths: list[Path]) -> None:
    rows = outcome_rows(read_compared(paths))
    assert rows["runs"] == ["3", "3"]
    low, high = stats.t.interval(0.95, 2, loc=30.0, scale=stats.sem(FINAL["bcm"]))
    assert low < 1, "CartPole's lowest return"
    assert rows["final best fitness"][0] == f"30.0 [1.0, {high:.1f}]"
    assert rows["held-out return"][0] == f"29.0 [1.0, {high - 1:.1f}]"


def test_score_is_that_of_the_budget(paths: list[Path], tmp_path: Path) -> None:
    assert "SCORE" not in outcome_rows(read_compared(paths)), (
        "not as many generations as the budget"
    )
    budget = load_configuration("smoke").budget
    generations = budget.generations_of("cartpole")
    whole = read_compared(written(tmp_path / "whole", generations))
    divisor = samples(generations, max(budget.populations_of("cartpole")))
    scores = [score([end + 2, end + 1, end], 6, divisor) for end in FINAL["neat"]]
    assert outcome_rows(whole)["SCORE"][1].startswith(f"{np.mean(scores):.3f} [")


def test_only_what_differs_is_named(paths: list[Path]) -> None:
    found = differing_constants(read_compared(paths))
    assert found["method"] == ["bcm", "neat"]
    assert set(found) == {
        "method", "plasticity.rule", "plasticity.learning_rate", "neat.weight_mutation"
    }  # fmt: skip
    assert differing_constants(read_compared([paths[0], paths[0]])) == {}


def test_curves_are_means_over_seeds(paths: list[Path]) -> None:
    (axes,) = learning_curves(read_compared(paths)).axes
    bcm, neat = axes.lines
    assert bcm.get_ydata().tolist() == [31.0, 30.0]
    assert neat.get_ydata().tolist() == [4.0, 3.0]
    assert bcm.get_label().startswith("A: BCM, P = 6, η = ")
    assert neat.get_label() == "B: NEAT, P = 6"
    assert bcm.get_color() != neat.get_color()


def test_records_of_one_method_look_different(paths: list[Path]) -> None:
    lines = learning_curves(read_compared([paths[0]] * 8)).axes[0].lines
    assert len({(line.get_color(), line.get_marker()) for line in lines}) == 8


def one_run(path: Path, like: Path, reward_scale: float) -> Path:
    """Write a record of one seed whose configuration differs from another's in the reward scale."""
    spec = read_compared([like])[0].spec
    plasticity = spec.plasticity.model_copy(update={"reward_scale": reward_scale})
    write_record(path, run(spec.model_copy(update={"plasticity": plasticity}), "smoke", 7.0))
    return path


def test_labels_that_coincide_name_the_constants_that_differ(
    paths: list[Path], tmp_path: Path
) -> None:
    louder = one_run(tmp_path / "louder.parquet", paths[0], reward_scale=0.5)
    (axes,) = learning_curves(read_compared([*paths, louder])).axes
    bcm, neat, bcm_louder = (str(line.get_label()).splitlines() for line in axes.lines)
    assert bcm[1:] == ["plasticity.reward_scale = 1.0"]
    assert neat[1:] == []
    assert bcm_louder[1:] == ["plasticity.reward_scale = 0.5"]


def test_bands_are_spoken_of_where_there_are_some(paths: list[Path], tmp_path: Path) -> None:
    alone = one_run(tmp_path / "one.parquet", paths[0], reward_scale=0.01)
    assert "bands" in learning_curves(read_compared([alone, paths[0]])).get_supxlabel()
    assert "bands" not in learning_curves(read_compared([alone])).get_supxlabel()


def test_a_folder_must_hold_one_configuration(paths: list[Path], tmp_path: Path) -> None:
    with pytest.raises(UserError, match="holds no records"):
        read_compared([tmp_path])
    mixed = tmp_path / "mixed"
    mixed.mkdir()
    for number, path in enumerate(paths):
        (record,) = path.glob("*.parquet")
        (mixed / f"{number}.parquet").write_bytes(record.read_bytes())
    with pytest.raises(UserError, match="of several configurations"):
        read_compared([mixed])
    record = read_record(mixed / "0.parquet")
    write_record(mixed / "1.parquet", dataclasses.replace(record, budget="demo"))
    with pytest.raises(UserError, match="budgets or readings; name them"):
        read_compared([mixed])
    (mixed / "1.parquet").write_bytes((mixed / "0.parquet").read_bytes())
    with pytest.raises(UserError, match="hold a seed twice"):
        read_compared([mixed])
