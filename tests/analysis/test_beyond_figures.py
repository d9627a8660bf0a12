"""What the pictures of `beyond` say; how they look was judged by eye."""

import pandas as pd

from neol.analysis import beyond_figures


def test_trials_that_lack_seeds_say_how_many_they_have() -> None:
    rows = [
        ("baseline", "hopper", "bcm", 3, 0.5, 0.5, 0.5),
        ("ReLU", "hopper", "bcm", 3, 0.7, 0.4, 0.9),
        ("sigmoid", "hopper", "bcm", 2, 0.7, 0.4, 0.9),
        ("beta 1", "hopper", "bcm", 0, float("nan"), float("nan"), float("nan")),
    ]
    columns = ["variant", "task", "method", "seeds", "a12", "low", "high"]
    table = pd.DataFrame(rows, columns=columns)
    figure = beyond_figures.sensitivity(table, ["hopper"], seeds=3, note="Made up.")
    assert [text.get_text() for text in figure.axes[0].texts] == ["2/3", "0/3"]
    assert "Seeds are missing: 2 of 4 trials are incomplete." in figure.get_supxlabel()
    whole = beyond_figures.sensitivity(table[:2], ["hopper"], seeds=3, note="Made up.")
    assert "missing" not in whole.get_supxlabel()
    assert "A mark without a line" not in whole.get_supxlabel()
    certain = table[:2].assign(a12=1.0, low=1.0, high=1.0)
    figure = beyond_figures.sensitivity(certain, ["hopper"], seeds=3, note="Made up.")
    assert "A mark without a line" in figure.get_supxlabel()


def test_profiles_say_what_lies_left_of_them() -> None:
    rows = [("bcm", -0.5, 0.75, 0.5, 1.0), ("bcm", 1.5, 0.0, 0.0, 0.0)]
    table = pd.DataFrame(rows, columns=["method", "threshold", "share", "low", "high"])
    said = beyond_figures.profiles(table, "Made up.").get_supxlabel()
    assert "Left of the axis: up to 25% of a method's runs." in said
    whole = beyond_figures.profiles(table.assign(share=1.0), "Made up.").get_supxlabel()
    assert "Left of the axis" not in whole


def test_runs_without_a_held_out_value_are_counted() -> None:
    columns = ["task", "method", "population", "runs", "without_value", "mean", "low", "high"]
    table = pd.DataFrame([("hopper", "bcm", 6, 3, 2, 1.0, 0.0, 2.0)], columns=columns)
    said = beyond_figures.selection(table, ["hopper"], "Made up.").get_supxlabel()
    assert "Left out: 2 runs whose champion failed" in said.replace("\n", " ")
    whole = beyond_figures.selection(table.assign(without_value=0), ["hopper"], "Made up.")
    assert "Left out" not in whole.get_supxlabel()
