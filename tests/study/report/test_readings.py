"""docs/readings.md, from made-up records: what it concludes, and what is to be confirmed."""

from pathlib import Path

import pytest

from neol.spec.configuration import ROOT
from neol.spec.readings import DEFAULT_READING
from neol.study.campaign.grid import RESULTS
from neol.study.campaign.multiverse import universes
from neol.study.campaign.search import CONFIRMATION
from neol.study.report.readings import confirmation_calls, page, write_page
from tests.helpers.baselines import PAPER, write_baseline
from tests.helpers.refusal import refusal
from tests.helpers.universes import write_universe

FAR = (200.0, 10.0, 150.0)


@pytest.fixture
def screened(tmp_path: Path) -> Path:
    """NEAT under worked_example is far off, under rare_mutation the paper's; no other has runs."""
    write_baseline(tmp_path, "worked_example", "neat", FAR)
    write_baseline(tmp_path, "worked_example", "neat_wo", PAPER["neat_wo"])
    write_baseline(tmp_path, "rare_mutation", "neat", PAPER["neat"])
    return tmp_path


def test_a_screening_names_what_is_to_be_confirmed(screened: Path) -> None:
    text, stage, _ = page(screened)
    assert stage.complete == ["rare_mutation", "worked_example"]
    assert "**Not yet confirmed**: this is the screening, with 3 seeds." in text
    assert "Compatible in it: `rare_mutation` (best of the generation)," in text
    assert "**Not yet run**: `small_mutation`, `removal`," in text
    assert "To be confirmed: `rare_mutation`, `worked_example`." in text
    assert "## Confirmation" not in text
    assert "9 runs of the screening (0.0 core-hours)" in text
    (row,) = (line for line in text.splitlines() if line.startswith("| `worked_example` | 2"))
    cells = [cell.split(" / ")[0] for cell in row.strip("| ").split(" | ")]
    assert cells[3:] == ["6", "200 ± 10", "150 ± 10", "**312 ± 9**", "**286 ± 9**"]
    assert "| the paper |  |  |  | 312 ± 8 | 291 ± 5 | 312 ± 9 | 286 ± 9 |" in text


def test_the_confirmation_alone_decides(screened: Path) -> None:
    write_baseline(screened, "worked_example", "neat", FAR, CONFIRMATION)
    write_baseline(screened, "worked_example", "neat_wo", PAPER["neat_wo"], CONFIRMATION)
    write_baseline(screened, "rare_mutation", "neat", FAR, CONFIRMATION)
    text, stage, _ = page(screened)
    assert stage.budget == CONFIRMATION
    assert "**Compatible** in the confirmation with 10 other seeds: none." in text
    assert (
        "**Outside the interval under every confirmed reading**: NEAT, final best of the "
        "generation; NEAT, mean best of the generation; NEAT, final best so far; "
        "NEAT, mean best so far."
    ) in " ".join(text.split())
    assert "## Confirmation" in text and "## Screening" in text


def test_the_calls_of_the_confirmation(screened: Path) -> None:
    lines = confirmation_calls(screened)
    assert [line.rpartition("=")[-1] for line in lines] == ["rare_mutation", "worked_example"]
    assert [line.count(".parquet") for line in lines] == [10, 20]
    assert all("--config budget=confirmation" in line for line in lines)


def test_the_page_and_its_picture_are_written(screened: Path, tmp_path: Path) -> None:
    output = tmp_path / "readings.md"
    write_page(output, screened)
    assert output.read_text() == page(screened).text
    assert output.with_suffix(".png").read_bytes().startswith(b"\x89PNG")


def test_without_a_complete_candidate_there_is_no_page(tmp_path: Path) -> None:
    line = refusal(write_page, tmp_path / "readings.md", tmp_path)
    assert line.endswith("no candidate of the search has all its runs; `make search`")


def test_the_multiverse_is_shown_where_a_reading_has_all_its_runs(screened: Path) -> None:
    assert "multiverse: does" not in page(screened).text
    first, other = universes()[:2]
    ends = {"neat": 100.0, "neat_wo": 110.0, "hebb": 120.0, "oja": 100.0, "bcm": 90.0}
    write_universe(screened, first, "cartpole", ends)
    write_universe(screened, other, "cartpole", ends | {"hebb": 80.0})
    text = " ".join(page(screened).text.split())
    assert "under 2 of 32 readings" in text
    assert "above under some readings and below under others: 6;" in text
    assert (
        "**Above under some readings and below under others** (6): final fitness against NEAT on "
        "CartPole (Hebb);"
    ) in text
    row = "| Hebb against NEAT (w/o) in final fitness | -10 | -30 to 10 | 50% | 50% | 50% |"
    assert row in text
    output = screened / "docs" / "readings.md"
    output.parent.mkdir()
    write_page(output, screened)
    names = {path.name for path in output.parent.iterdir()}
    assert names == {
        "readings.md",
        "readings.png",
        "readings-multiverse.csv",
        "readings-multiverse-cartpole.png",
    }


def test_the_default_is_the_reading_that_the_confirmation_found_nearest() -> None:
    _, stage, _ = page(ROOT / RESULTS)
    assert (stage.budget, stage.complete[0]) == (CONFIRMATION, DEFAULT_READING)
