"""The page says what the table says."""

import re
from pathlib import Path

import pytest

from benchmarks.episode_lengths import content
from benchmarks.report import render, write
from benchmarks.scaling import BEGIN, END, spent
from benchmarks.table import Key, markdown, number, percent, summarise
from neol.spec.configuration import ROOT
from neol.study.campaign.cost import EPISODE_LENGTHS

ABOUT = {"CPU": "2 x Abacus", "Date": "2026-01-01", "Run": "made up"}


def made_up(task: str) -> dict[Key, list[float]]:
    """Two rounds; the second is twice as slow for all but the peer."""
    rounds = {
        **{("engine", n): [13.0, 26.0] for n in ("initial", "large")},
        **{("physics", n): [10.0, 20.0] for n in ("initial", "large")},
        ("envpool_single", "initial"): [50.0, 100.0],
        ("envpool_batch", "initial"): [12.5, 30.0],
        **{("resets", n): [1.0, 2.0] for n in ("initial", "large")},
        **{("network", n): [1.0, 2.0] for n in ("initial", "large")},
        **{("plasticity", n): [0.5, 1.0] for n in ("initial", "large")},
        **{("gymnasium", n): [30.0, 60.0] for n in ("initial", "large")},
        **{("reference", n): [40.0, 80.0] for n in ("initial", "large")},
        **{(f"kernels_{rule}", "large"): [1.6, 3.2] for rule in ("hebb", "oja", "bcm")},
        **{(f"c_{rule}", "large"): [1.0, 2.0] for rule in ("hebb", "oja", "bcm")},
        ("run", ""): [20.0, 40.0],
        ("peer", ""): [100.0, 100.0],
        **{(f"run_{part}", ""): [2.0, 4.0] for part in ("network", "plasticity", "neat", "other")},
        ("run_generations", ""): [10.0],
        ("neat_generation", ""): [30.0, 60.0],
        ("one_worker", ""): [1.9, 3.8],
        ("two_workers", ""): [1.0, 2.0],
        ("serial_share", ""): [0.25, 0.25],
        ("short_run", "hebb"): [20.0],
        ("short_run", "neat"): [20.0],
        ("short_run_late_steps", "hebb"): [180.0],
        ("short_run_late_steps", "neat"): [180.0],
    }
    return {(quantity, task, networks): v for (quantity, networks), v in rounds.items()}


def test_ratios_are_taken_within_a_round() -> None:
    table = summarise(made_up("hopper")).set_index(["quantity", "networks"])
    assert table.loc[("times_faster", ""), "median"] == pytest.approx((5.0 + 2.5) / 2)
    ratio = table.loc[("engine_over_physics", "initial")]
    assert (ratio["minimum"], ratio["maximum"], ratio["rounds"]) == pytest.approx((1.3, 1.3, 2))
    assert table.loc[("steps_over_physics", "initial"), "median"] == pytest.approx(1.2)
    ratio = table.loc[("engine_over_envpool", "initial")]
    assert (ratio["minimum"], ratio["maximum"]) == pytest.approx((26 / 30, 13 / 12.5))
    assert table.loc[("share_environment", ""), "median"] == pytest.approx(0.6)
    assert table.loc[("two_workers_speedup", ""), "median"] == pytest.approx(1.9)
    assert table.loc[("two_workers_bound", ""), "median"] == pytest.approx(1 / (0.25 + 0.75 / 2))
    # 30 ms against 300 episodes of 180 steps of 13 microseconds
    share = 0.030 / (0.030 + 300 * 180 * 13e-6)
    assert table.loc[("neat_share", ""), "minimum"] == pytest.approx(share)


def test_the_page_says_which_targets_are_met(tmp_path: Path) -> None:
    write(tmp_path, summarise(made_up("hopper")), ABOUT)
    page = (tmp_path / "benchmarks.md").read_text()
    assert "- CPU: 2 x Abacus" in page
    assert "| whole run: times as fast as the peer | Hopper | ≥ 3.00 | 3.75 | met |" in page
    what = "engine / physics of the unmodified library"
    assert f"| {what} | Hopper | ≤ 0.92 | 1.30 | **missed** |" in page
    assert "| engine / EnvPool's stepping alone | Hopper | ≤ 1.10 | 0.95 | met |" in page
    assert "| Hopper | 75.0 | 32 | 21.2 | 19.5 | 0.95 |" in page
    assert "| ≤ 1.50 µs or ≤ 1.30 × C | 2.40 µs, 1.60 × C | **missed** |" in page
    assert "CartPole |" not in page
    assert (tmp_path / "benchmarks.png").read_bytes().startswith(b"\x89PNG")


def test_each_path_through_box2d_has_its_target(tmp_path: Path) -> None:
    rounds = made_up("lunar_lander")
    for networks in ("initial", "large"):
        rounds["engine_plain", "lunar_lander", networks] = [13.0, 26.0]
        rounds["engine_avx2", "lunar_lander", networks] = [2.0, 6.0]
    write(tmp_path, summarise(rounds), ABOUT)
    page = (tmp_path / "benchmarks.md").read_text()
    what = "engine on path avx2 / physics of the unmodified library"
    assert f"| {what} | LunarLander | ≤ 0.25 | 0.25 | met |" in page
    assert "path shortcut" not in page
    row = (
        "| LunarLander, large | 15.0 | 19.5 | – | – | 4.00 | – | – | 1.30 | – | – | 0.25 | – | – |"
    )
    assert row in page


@pytest.mark.slow
def test_what_the_shipped_budget_took_is_what_its_records_say() -> None:
    page = (ROOT / "docs" / "scaling.md").read_text(encoding="utf-8")
    assert f"\n{spent('evidence')}\n" in page


@pytest.mark.slow
def test_episodes_are_as_long_as_in_the_shipped_records() -> None:
    assert EPISODE_LENGTHS.read_bytes() == content()


@pytest.mark.slow
def test_scaling_is_written_between_its_markers(tmp_path: Path) -> None:
    (tmp_path / "scaling.md").write_text(f"before\n{BEGIN}\nold\n{END}\nafter\n")
    write(tmp_path, summarise(made_up("lunar_lander")), ABOUT)
    text = (tmp_path / "scaling.md").read_text()
    assert text.startswith(f"before\n{BEGIN}\n")
    assert text.endswith(f"{END}\nafter\n")
    assert "old" not in text
    # 136.5 million evaluations of at most 1000 steps of 20 microseconds, and 150 of NEAT
    (row,) = re.findall(r"\| LunarLander \| 136\.5 \| ([\d.,]+) \| ([\d.,]+) \|", text)
    assert row[1] == number(136.5e6 * (1000 * 20 + 150) / 3600e6)
    render(tmp_path)
    assert (tmp_path / "scaling.md").read_text() == text


def test_numbers_have_three_digits() -> None:
    assert [number(v) for v in (1234.5, 99.95, 12.34, 0.456, None)] == [
        "1,234",
        "100.0",
        "12.3",
        "0.46",
        "–",
    ]
    assert percent(0.1234) == "12.3%"
    assert markdown(("a", "b"), [("1", "2")]) == "| a | b |\n| --- | ---: |\n| 1 | 2 |\n"
