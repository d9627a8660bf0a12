"""neol replay, show, compare, export: files, output and refused input."""

import json
import os
import re
import subprocess
import sys
from dataclasses import replace
from pathlib import Path

import pytest
from PIL import Image

from neol import cli
from neol.champions.player import load_champion
from neol.run.record_file import read_record, write_record
from tests.champions.conftest import MakeRecord
from tests.champions.conftest import record_of as record_of
from tests.helpers.command import neol, refused


@pytest.fixture(autouse=True)
def _folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch, record_of: MakeRecord) -> None:
    """Write a.parquet and b.parquet, with three held-out episodes of seeds 3 and 4."""
    for name, method in (("a", "bcm"), ("b", "neat")):
        (tmp_path / f"{name}.parquet").write_bytes(record_of("cartpole", method).read_bytes())
    monkeypatch.chdir(tmp_path)


def test_replay_prints_both_returns() -> None:
    outcome = neol("replay a.parquet --seed 4")
    assert outcome.exit_code == 0
    player = load_champion("a.parquet", 4)
    title, _, *rows = outcome.stdout.splitlines()
    champion = "a.parquet: champion of seed 4, CartPole-v1"
    assert title == f"{champion}, 3 of its 3 held-out episodes"
    assert [row.split()[2:] for row in rows] == [[repr(r)] * 2 for r in player.recorded_returns]


def test_replay_begins_where_it_is_told_to() -> None:
    rows = neol("replay a.parquet --first 1 --episodes 1").stdout.splitlines()[2:]
    assert [row.split()[0] for row in rows] == ["1"]


def test_replay_says_that_there_are_no_more() -> None:
    title, _, *rows = neol("replay a.parquet --first 2 --episodes 5").stdout.splitlines()
    assert title.endswith(", 1 of its 3 held-out episodes")
    assert len(rows) == 1


@pytest.mark.parametrize("command", ["replay", "show", "export --format json --output a.json"])
def test_a_record_of_another_environment(command: str, tmp_path: Path) -> None:
    record = read_record(tmp_path / "a.parquet")
    task = record.spec.task.model_copy(update={"environment": "LunarLander-v3"})
    foreign = replace(record, spec=record.spec.model_copy(update={"task": task}))
    write_record(tmp_path / "foreign.parquet", foreign)
    line = refused(f"{command} foreign.parquet")
    assert "foreign.parquet: its networks have 4 inputs and 2 outputs, LunarLander-v3 needs" in line


@pytest.mark.parametrize("command", ["replay", "show --plasticity"])
def test_a_rule_that_is_not_here(command: str, tmp_path: Path) -> None:
    record = read_record(tmp_path / "a.parquet")
    plasticity = record.spec.plasticity.model_copy(update={"rule": "leaky"})
    foreign = replace(record, spec=record.spec.model_copy(update={"plasticity": plasticity}))
    write_record(tmp_path / "foreign.parquet", foreign)
    assert 'foreign.parquet: unknown rule "leaky"' in refused(f"{command} foreign.parquet")


@pytest.mark.parametrize(
    ("command", "output"),
    [
        pytest.param("replay a.parquet --gif", "a.gif", marks=pytest.mark.slow),
        ("show a.parquet --output", "a.png"),
        ("compare a.parquet --output", "a.png"),
        ("export a.parquet --format json --output", "a.json"),
    ],
)
def test_a_folder_that_is_not_there_is_made(command: str, output: str, tmp_path: Path) -> None:
    outcome = neol(f"{command} new/one/{output}")
    assert outcome.exit_code == 0, outcome.stderr
    assert (tmp_path / "new" / "one" / output).stat().st_size > 0


@pytest.mark.parametrize(
    "command",
    [
        "replay a.parquet --gif b.parquet/a.gif",
        "show a.parquet --output b.parquet/new/a.png",
        "compare a.parquet --output b.parquet/a.png",
        "export a.parquet --format json --output b.parquet/a.json",
    ],
)
def test_what_cannot_be_written_is_refused_before_the_work(command: str, tmp_path: Path) -> None:
    assert f"{tmp_path / 'b.parquet'} is not a writable folder" in refused(command)


def test_a_read_only_folder_is_refused_before_the_work(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(os, "access", lambda _, mode: not mode & os.W_OK)  # not even root
    assert f"a.gif: {tmp_path} is not a writable folder" in refused("replay a.parquet --gif a.gif")


@pytest.mark.slow
def test_replay_films_the_first_of_them(tmp_path: Path) -> None:
    outcome = neol("replay a.parquet --first 1 --gif a.gif")
    assert outcome.exit_code == 0
    assert outcome.stdout.splitlines()[-1] == "a.gif: episode 1 filmed"
    assert Image.open(tmp_path / "a.gif").n_frames > 2


def test_a_replay_that_differs_ends_with_3(tmp_path: Path) -> None:
    record = read_record(tmp_path / "a.parquet")
    first, second = record.seeds
    returns = (*first.held_out.returns[:2], 77.5)
    altered = first.model_copy(
        update={"held_out": first.held_out.model_copy(update={"returns": returns})}
    )
    write_record(tmp_path / "altered.parquet", replace(record, seeds=(altered, second)))
    outcome = neol("replay altered.parquet")
    assert outcome.exit_code == 3
    assert "77.5" in outcome.stdout
    (line,) = outcome.stderr.splitlines()
    assert line.startswith(
        "neol: altered.parquet: the replay differs in episode 2 of seed 3: edited"
    )
    assert neol("replay altered.parquet --episodes 2").exit_code == 0
    assert neol("replay altered.parquet --seed 4").exit_code == 0


@pytest.mark.slow
def test_replay_in_a_window() -> None:
    """Use an invisible window of SDL, in a separate process that does not affect other tests."""
    ran = subprocess.run(
        [sys.executable, "-m", "neol", "replay", "a.parquet", "--episodes", "1", "--human"],
        env=os.environ
        | {"PYTHONPATH": str(Path(cli.__file__).parents[2]), "DISPLAY": ":0"}
        | {"SDL_VIDEODRIVER": "dummy"},
        capture_output=True,
        text=True,
        timeout=120,
        check=False,
    )
    assert ran.returncode == 0, ran.stderr


@pytest.mark.slow
@pytest.mark.parametrize("kind", ["png", "pdf", "svg"])
def test_show_draws(kind: str, tmp_path: Path) -> None:
    outcome = neol(f"show a.parquet --output a.{kind}")
    assert outcome.stdout == f"a.{kind}: champion of seed 3\n"
    assert len((tmp_path / f"a.{kind}").read_bytes()) > 5000


@pytest.mark.slow
def test_show_draws_learning(tmp_path: Path) -> None:
    assert neol("show a.parquet --plasticity --episode 2 --seed 4").exit_code == 0
    width, height = Image.open(tmp_path / "champion.png").size
    assert width > 1000
    assert height > 1000


def test_compare_prints_what_differs_and_what_came_of_it(tmp_path: Path) -> None:
    outcome = neol("compare a.parquet b.parquet --output curves.png")
    assert outcome.exit_code == 0
    rows = {row[0]: row[1:] for row in map(_cells, outcome.stdout.splitlines()) if len(row) == 3}
    assert rows["method"] == ["bcm", "neat"]
    assert rows["plasticity.learning_rate"] == ["0.25", "0.0"]
    assert "task.name" not in rows
    assert rows["runs"] == ["2", "2"]
    assert Image.open(tmp_path / "curves.png").width > 1000


def _cells(line: str) -> list[str]:
    return re.split(r" {2,}", line.strip())


@pytest.mark.parametrize("kind", ["json", "onnx"])
def test_export_writes_a_network(kind: str, tmp_path: Path) -> None:
    if kind == "onnx":
        pytest.importorskip("onnx")
    outcome = neol(f"export a.parquet --format {kind} --seed 4 --output out")
    assert outcome.stdout == "out: champion of seed 4, CartPole-v1\n"
    content = (tmp_path / "out").read_bytes()
    if kind == "json":
        assert json.loads(content)["seed"] == 4
    else:
        assert b"CartPole-v1" in content


@pytest.mark.parametrize("command", ["replay", "show", "compare", "export"])
@pytest.mark.slow
def test_the_examples_of_the_help_work(command: str, tmp_path: Path) -> None:
    (tmp_path / "results").symlink_to(Path(cli.__file__).parents[2] / "results")
    page = neol(f"{command} --help").stdout.replace("\\\n", " ")
    examples = re.findall(r"^ +neol (.*)$", page, re.MULTILINE)
    assert examples
    for example in examples:
        here = re.sub("--(first|episode) 7", r"--\1 2", example)  # of three
        outcome = neol(here)
        assert outcome.exit_code == 0, outcome.stderr


@pytest.mark.parametrize(
    ("arguments", "line"),
    [
        ("replay none.parquet", "none.parquet: cannot be read (No such file"),
        ("replay a.parquet --seed 9", "a.parquet: has no seed 9; its seeds are 3, 4"),
        ("replay a.parquet --first 3", "a.parquet: has no held-out episode 3; they are 0 to 2"),
        ("replay a.parquet --episodes 0", "Invalid value for '--episodes'"),
        ("replay a.parquet --gif a.png", "a.png: films are GIFs; end its name in .gif"),
        ("replay a.parquet --gif .", ".: is a folder; name a file in it"),
        ("show a.parquet --output a.jpg", "a.jpg: pictures are pdf, png, svg"),
        ("show a.parquet --plasticity --episode 3", "has no held-out episode 3"),
        ("show b.parquet --plasticity", "NEAT does not learn within an episode"),
        ("compare", "compare needs RECORD; for example: neol compare a.parquet"),
        ("compare a.parquet none.parquet", "none.parquet: cannot be read"),
        ("export a.parquet --output a", "export needs --format; for example"),
        ("export a.parquet --format xml --output a", "'xml' is not one of 'json', 'onnx'"),
        ("export a.parquet --format json --output .", ".: is a folder; name a file in it"),
    ],
)
def test_wrong_input(arguments: str, line: str, tmp_path: Path) -> None:
    before = sorted(tmp_path.iterdir())
    assert line in refused(arguments)
    assert sorted(tmp_path.iterdir()) == before


def test_a_window_without_a_display(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(sys, "platform", "linux")
    for variable in ("DISPLAY", "WAYLAND_DISPLAY"):
        monkeypatch.delenv(variable, raising=False)
    assert "no display to open a window on" in refused("replay a.parquet --human")


@pytest.mark.slow
def test_the_commands_of_the_document_work(tmp_path: Path) -> None:
    root = Path(cli.__file__).parents[2]
    text = (root / "docs" / "how-to" / "watch-a-champion.md").read_text(encoding="utf-8")
    (record,) = re.findall(r"^record=(.+)$", text, re.MULTILINE)
    commands = re.findall(r"^neol ([^#\n]+)", text, re.MULTILINE)
    assert len(commands) == 5
    (tmp_path / "results").symlink_to(root / "results")
    for command in commands:
        outcome = neol(command.replace("$record", record))
        assert outcome.exit_code == 0, outcome.stderr
    assert {path.name for path in tmp_path.iterdir()} >= {
        "moon.gif", "network.png", "learning.png", "moon.json"
    }  # fmt: skip
