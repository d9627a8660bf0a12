"""The command line: its output and refused input (test_ending: its endings)."""

import json
import re
from pathlib import Path

import pytest

from neol.base.errors import UserError
from neol.cli.run import parse_seeds
from neol.run.record_file import read_record
from neol.spec.configuration import CONFIG, load_configuration
from neol.spec.plain_yaml import parse_yaml
from neol.spec.readings import DEFAULT_READING
from tests.helpers import troubled as troubled
from tests.helpers.command import TINY, neol, refused, specification
from tests.helpers.core import require_core
from tests.helpers.runs import evolve, names

pytestmark = pytest.mark.usefixtures("own_folder")

# --- Running ------------------------------------------------------------------------------------


def test_run_writes_the_record_and_sums_it_up(tmp_path: Path) -> None:
    outcome = neol(f"run {TINY} --seed 3 --output a.parquet")
    assert outcome.exit_code == 0
    record = read_record(tmp_path / "a.parquet")
    assert record.budget is None
    (info,) = record.seeds
    assert info.digest == evolve(record.spec).state.digest
    first, second = outcome.stdout.splitlines()
    assert first == "a.parquet: written (engine: reference)"
    assert second == (
        f"seed 3: best {info.champion.fitness:.1f}, champion in 3 held-out episodes "
        f"{info.held_out.mean:.1f} ± {info.held_out.sd:.1f}, digest {info.digest}"
    )
    assert names(tmp_path) == ["a.parquet"]


def test_run_says_which_physics_played(monkeypatch: pytest.MonkeyPatch) -> None:
    require_core()
    small = TINY.replace("cartpole", "lunar_lander").replace("--engine reference", "")
    monkeypatch.setenv("NEOL_BOX2D_PATH", "shortcut")
    first, _ = neol(f"run {small} --output a.parquet").stdout.splitlines()
    assert first == "a.parquet: written (engine: fast; physics: shortcut)"
    monkeypatch.setenv("NEOL_BOX2D_PATH", "faster")
    assert 'NEOL_BOX2D_PATH: no path "faster" on this machine; choose plain, shortcut' in refused(
        f"run {small} --output b.parquet"
    )


def test_digest_prints_a_line_per_seed(tmp_path: Path) -> None:
    neol(f"run {TINY} --seed 0,2 --output a.parquet")
    record = read_record(tmp_path / "a.parquet")
    lines = [f"{info.seed} {info.digest}" for info in record.seeds]
    assert neol("digest a.parquet").stdout.splitlines() == lines
    assert [line[:2] for line in lines] == ["0 ", "2 "]


def test_quiet_says_nothing() -> None:
    outcome = neol(f"run {TINY} --quiet --output a.parquet")
    assert (outcome.exit_code, outcome.output) == (0, "")


def test_every_option_reaches_the_run(monkeypatch: pytest.MonkeyPatch) -> None:
    spec, settings = specification(
        "run --task hopper --method bcm --population 50 --learning-rate 0.0025 --generations 20 "
        "--seed 4-6 --output b.parquet --episodes 2 --max-steps 77 --reward-scale 0.5 "
        "--weight-mutation 0.3 --no-write-back --workers 2 --checkpoint-every 5 --resume "
        "--keep-partial --engine reference --budget smoke --set neat.elitism=1 "
        "--reading first+neat.max_stagnation=7 --set network.sum_limit=9",
        monkeypatch,
    )
    assert (spec.task.name, spec.task.max_steps, spec.method) == ("hopper", 77, "bcm")
    assert (spec.population, spec.generations) == (50, 20)
    assert (spec.plasticity.rule, spec.plasticity.learning_rate) == ("bcm", 0.0025)
    assert (spec.plasticity.reward_scale, spec.plasticity.write_back) == (0.5, False)
    assert (spec.neat.weight_mutation, spec.neat.elitism) == (0.3, 1)
    assert (spec.evaluation.episodes, spec.evaluation.held_out_episodes) == (2, 5)
    assert (spec.network.sum_limit, spec.neat.max_stagnation) == (9, 7)
    assert spec.neat.crossover_enabled == "redraw_if_disabled"
    del settings["on_generation"]
    assert settings == {
        "seeds": [4, 5, 6],
        "output": Path("b.parquet"),
        "engine": "reference",
        "workers": 2,
        "checkpoint_every": 5,
        "resume": True,
        "keep_partial": True,
        "budget": "smoke",
        "reading": "first+neat.max_stagnation=7",
    }


def test_without_options_the_configuration_holds(monkeypatch: pytest.MonkeyPatch) -> None:
    arguments = (
        "run --task hopper --method neat --population 50 --generations 20 --output b.parquet"
    )
    spec, _ = specification(arguments, monkeypatch)
    cell = {"task": "hopper", "method": "neat", "population": 50, "learning_rate": None}
    assert spec == load_configuration("paper").run_spec(**cell, generations=20, seed=0)


def test_config_is_a_configuration_that_reads_back() -> None:
    printed = neol("config --budget desk --set neat.elitism=3").stdout
    content = parse_yaml(printed, "config")
    assert content["neat"]["elitism"] == 3
    assert content["budget"]["generations"] == load_configuration("desk").budget.generations
    assert content["methods"]["oja"]["weight_mutation"] == "off"
    schema = json.loads(neol("config --schema").stdout)
    assert set(content) <= set(schema["properties"])


@pytest.mark.parametrize(
    ("text", "seeds"),
    [("3", [3]), ("0-4", [0, 1, 2, 3, 4]), ("7,0,3", [0, 3, 7]), ("0-1,5", [0, 1, 5])],
)
def test_seeds(text: str, seeds: list[int]) -> None:
    assert parse_seeds(text) == seeds


@pytest.mark.parametrize("text", ["", "a", "-1", "1-", "3,,4", "2-1", "1,1", "0-999999999", "1.5"])
def test_wrong_seeds(text: str) -> None:
    with pytest.raises(UserError, match=re.escape(f"--seed {text}: ")):
        parse_seeds(text)


# --- Wrong input --------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("change", "line"),
    [
        ("--task cartpol", 'unknown task "cartpol", did you mean "cartpole"?'),
        ("--method ojja --weight-mutation off", 'unknown method "ojja", did you mean "oja"?'),
        ("--budget dsk", 'unknown budget "dsk", did you mean "desk"?'),
        ("--population 0", "population = 0: must be"),
        ("--population 1", "population = 1: must be"),
        ("--learning-rate -0.1", "learning_rate = -0.1: must be"),
        ("--learning-rate nan", "learning_rate = nan: must be"),
        ("--generations 0", "generations = 0: must be"),
        ("--method neat", "neat does not learn online; leave it out"),
        ("--seed x", "--seed x: give integers"),
        ("--episodes 0", "neol: --episodes = 0: must be"),
        ("--max-steps 0", "neol: --max-steps = 0: must be"),
        (
            "--weight-mutation 2",
            "neol: --weight-mutation = 2: must be 'off', 'config' or a probability",
        ),
        ("--weight-mutation [", "neol: --weight-mutation [, line 1: "),
        ("--set neat.elitism=x", "neol: --set: neat.elitism = 'x': must be"),
        ("--set neat.elitsm=1", 'did you mean "elitism"?'),
        ("--set neat.elitism", "write it as key=value"),
        ("--population many", "Invalid value for '--population'"),
        ("--engine quick", "Invalid value for '--engine'"),
        ("--workers 0", "Invalid value for '--workers'"),
        ("--loud", "No such option: --loud"),
        ("--task gym:Nope-v0", "Environment `Nope` doesn't exist"),
        ("--task gym:Image-v0", "Image-v0 observes Box(0, 255, (8, 8, 3), uint8); a network needs"),
        ("--output file/a.parquet", "file/a.parquet.partial: cannot be made (Not a directory)"),
        ("--output .", ".: records are Parquet files; end its name in .parquet"),
        ("--output folder.parquet", "folder.parquet: is a folder; name a file in it"),
        ("--output a.csv", "a.csv: records are Parquet files; end its name in .parquet"),
    ],
)
def test_wrong_input_of_run(change: str, line: str, tmp_path: Path) -> None:
    (tmp_path / "file").touch()
    (tmp_path / "folder.parquet").mkdir()
    assert line in refused(f"run {TINY} --output a.parquet {change}")
    assert names(tmp_path) == ["file", "folder.parquet"]


def test_wrong_commands() -> None:
    assert "No such command 'rum'. Did you mean 'run'? (root --help says more)" in refused("rum")
    assert 'unknown budget "x"' in refused("config --budget x")


def test_what_is_missing_is_said_at_once_with_an_example() -> None:
    said = refused("run --task cartpole --seed 3")
    assert said.startswith(
        "neol: root run needs --method, --population, --generations, --output; "
        "for example: neol run --task cartpole --method oja --population 50 "
    )
    assert "--generations 10 --seed 0-4 --output a.parquet (root run --help)" in said
    assert "digest needs RECORD; for example: neol digest a.parquet (" in refused("digest")
    assert "export needs --format, --output; for" in refused("export a.parquet")
    assert neol("run --help").exit_code == 0


def test_a_seed_above_the_limit_is_refused_with_the_limit() -> None:
    limit = 2**63 - 1
    assert parse_seeds(str(limit)) == [limit]
    for seed in (str(limit + 1), f"0-{limit + 1}", "9" * 5000):
        with pytest.raises(UserError, match=f"the largest seed is {limit}"):
            parse_seeds(seed)


def test_a_budget_may_be_a_file_of_ones_own(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    text = (CONFIG / "smoke.yaml").read_text(encoding="utf-8")
    (tmp_path / "mine.yaml").write_text(text + "neat:\n  elitism: 3\n", encoding="utf-8")
    spec, settings = specification(f"run {TINY} --budget mine.yaml --output a.parquet", monkeypatch)
    assert (spec.neat.elitism, settings["budget"]) == (3, "mine")
    shown = neol("config --budget ./mine.yaml").stdout
    assert shown.startswith(f"# Budget mine, reading {DEFAULT_READING}\n")
    assert "no.yaml: cannot be read (No such file" in refused("config --budget no.yaml")
    assert "mine.yaml: a campaign needs a budget of config/" in refused("status mine.yaml")


@pytest.mark.parametrize(
    ("command", "line"),
    [
        (
            "show figures/table1.tex",
            "figures/table1.tex: that is a table, not a record; neol trace",
        ),
        (
            "digest figure2.pdf",
            "figure2.pdf: that is a figure, not a record; neol trace figure2.pdf",
        ),
        ("verify a.parquet beyond.csv", "beyond.csv: that is not a record; neol trace beyond.csv"),
        ("compare a.parquet table1.json", "table1.json: that is a table, not a record; neol trace"),
    ],
)
def test_a_table_is_no_record(command: str, line: str) -> None:
    assert line in refused(command)


def test_records_that_are_none(tmp_path: Path) -> None:
    assert "none.parquet: cannot be read (No such file" in refused("digest none.parquet")
    (tmp_path / "a.parquet").write_bytes(b"hello")
    said = refused("digest a.parquet")
    assert "a.parquet: damaged, or not a record of neol" in said
    assert ".;" not in said


def test_an_existing_output_is_never_overwritten(tmp_path: Path) -> None:
    command = f"run {TINY} --output a.parquet"
    neol(command)
    before = (tmp_path / "a.parquet").read_bytes()
    assert "a.parquet: already exists; remove it or choose" in refused(command)
    again = neol(f"{command} --resume")
    assert again.exit_code == 0
    assert again.stdout.startswith("a.parquet: already complete, nothing to do\nseed 0: best")
    assert "of another specification" in refused(f"{command} --resume --population 7")
    assert (tmp_path / "a.parquet").read_bytes() == before


def test_an_environment_that_returns_nan_does_not_stop_a_run(tmp_path: Path) -> None:
    assert neol(f"run {TINY} --task gym:NaNReward-v0 --output a.parquet").exit_code == 0
    assert read_record(tmp_path / "a.parquet").table["failed_evaluations"][-1].as_py() > 0


@pytest.mark.parametrize(
    ("readings", "line"),
    [
        ("--reading first --reading removal", "--reading first --reading removal: give one"),
        ("--reading frist", 'unknown reading "frist", did you mean "first"? (allowed: '),
        ("--reading first+budget.seeds=3", '"budget.seeds=3": a reading sets no budget'),
    ],
)
def test_a_reading_that_cannot_be_is_refused(readings: str, line: str) -> None:
    assert refused(f"config {readings}").startswith(f"neol: {line}")
    run = f"run {TINY} --output a.parquet {readings}"
    assert refused(run).startswith(f"neol: {line}")


def test_a_record_of_another_reading_is_refused(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    run = f"run {TINY} --quiet --output a.parquet"
    assert neol(f"{run} --reading first").exit_code == 0
    assert read_record(tmp_path / "a.parquet").reading == "first"
    line = refused(f"{run} --resume")
    assert "a.parquet: of another specification: neat.bias_mutate_rate is " in line
