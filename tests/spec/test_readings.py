"""Readings: named constants, labels and refused input."""

import json
from pathlib import Path

import jsonschema
import pytest

from neol.spec import configuration as spec
from neol.spec.configuration import READINGS, load_configuration, reading_schema
from neol.spec.plain_yaml import read_yaml
from neol.spec.readings import BASE_READING, DEFAULT_READING, read_reading, readings
from neol.spec.run_spec import ADDED_LATER, RunSpec, complete
from tests.helpers.refusal import refusal
from tests.helpers.runs import run_spec


@pytest.mark.parametrize("name", readings(READINGS))
def test_every_reading_can_be_run(name: str) -> None:
    configuration = load_configuration("smoke", reading=name)
    assert configuration.reading == name
    for method in ("neat", "neat_wo"):
        configuration.run_spec(
            task="lunar_lander", method=method, population=50, generations=1
        ).digest()


def test_without_a_reading_the_default_is_used() -> None:
    assert load_configuration("paper") == load_configuration("paper", reading=DEFAULT_READING)


def test_a_reading_changes_the_constants_of_the_base_file() -> None:
    assert read_reading(READINGS, BASE_READING).constants == {}
    first = load_configuration("paper", reading="first")
    assert first.plasticity.reward_scale == 0.01
    assert first.neat.crossover_enabled == "redraw_if_disabled"


def test_a_budget_overlays_a_reading_and_overrides_overlay_both() -> None:
    configuration = load_configuration("smoke", ["plasticity.reward_scale=0.5"], reading="first")
    assert configuration.plasticity.reward_scale == 0.5
    assert configuration.evaluation.held_out_episodes == 5
    assert configuration.reading == "first"


@pytest.mark.parametrize(
    ("label", "canonical"),
    [
        ("first+plasticity.reward_scale=1e-1", "first+plasticity.reward_scale=0.1"),
        (
            "worked_example+plasticity.write_back=false+neat.elitism=3",
            "worked_example+neat.elitism=3+plasticity.write_back=false",
        ),
        ("worked_example+neat.weight_limit=1e+20", "worked_example+neat.weight_limit=1e+20"),
        ("first+methods.neat.weight_mutation=off", "first+methods.neat.weight_mutation=off"),
    ],
)
def test_a_label_names_a_reading_and_changed_constants(label: str, canonical: str) -> None:
    assert load_configuration("smoke", reading=label).reading == canonical
    again = load_configuration("smoke", reading=canonical)
    assert again == load_configuration("smoke", reading=label)


@pytest.mark.parametrize(
    ("label", "expected"),
    [
        ("frist", 'unknown reading "frist", did you mean "first"? (allowed: drawn_bias, '),
        ("", 'unknown reading "" (allowed: drawn_bias, '),
        ("../readings/first", 'unknown reading "../readings/first"'),
        ("first,removal", 'unknown reading "first,removal"; give one reading, '),
        ("first+default", '--reading "default": write it as key=value'),
        ("first+neat.elitsm=3", '--reading: neat.elitsm: unknown key, did you mean "elitism"?'),
        ("first+budget.seeds=3", '"budget.seeds=3": a reading sets no budget; --budget chooses'),
        ("first+neat={elitism: 3}", '"neat={"weight_init_sd": 1.0'),
    ],
)
def test_a_label_that_is_not_allowed(label: str, expected: str) -> None:
    assert refusal(load_configuration, "smoke", reading=label).startswith(expected)


READING = "summary: One.\nspeaks_for: Two.\nspeaks_against: Three.\nconstants: "


@pytest.mark.parametrize(
    ("content", "expected"),
    [
        (READING + "{neat: {elitsm: 3}}", "readings/mine.yaml: neat.elitsm: unknown key, did you"),
        (READING + "{neat: {elitism: x}}", "readings/mine.yaml: neat.elitism = 'x': must be a"),
        (READING + "{neet: {elitism: 3}}", "readings/mine.yaml: neet: unknown key, did you mean"),
        (READING + "{neat: 3}", "readings/mine.yaml: constants.neat = 3: must be"),
        (READING + "{budget: {seeds: 3}}", "readings/mine.yaml: constants.budget: a reading sets"),
        ("summary: One.\n", "readings/mine.yaml: speaks_for: is missing"),
        (READING + "{}\nname: mine\n", "readings/mine.yaml: name: unknown key"),
        ("- 1\n", "readings/mine.yaml: must be a mapping of keys to values"),
        ("{", "readings/mine.yaml, line 1: "),
    ],
)
def test_a_file_that_is_not_allowed(
    content: str, expected: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    folder = tmp_path / "readings"
    folder.mkdir()
    (folder / "mine.yaml").write_text(content)
    monkeypatch.setattr(spec, "READINGS", folder)
    assert refusal(load_configuration, "smoke", reading="mine").startswith(expected)


def test_no_file_of_a_budget_names_a_reading() -> None:
    text = refusal(load_configuration, "smoke", ["reading=first"])
    assert text == "--set: reading: unknown key; --reading sets it"


def test_the_schema_is_that_of_the_types() -> None:
    written = json.loads((READINGS / "schema.json").read_text())
    assert written == reading_schema(), "run `python -m neol.spec.configuration`"


@pytest.mark.parametrize("name", readings(READINGS))
def test_the_schema_accepts_the_files(name: str) -> None:
    path = READINGS / f"{name}.yaml"
    assert path.read_text().startswith("# yaml-language-server: $schema=schema.json\n")
    jsonschema.validate(read_yaml(path, name), reading_schema())


@pytest.mark.parametrize(
    "constants", [{"neet": {}}, {"neat": {"elitsm": 3}}, {"budget": {"seeds": 3}}]
)
def test_the_schema_refuses_what_the_types_refuse(constants: dict[str, object]) -> None:
    texts = {"summary": "1", "speaks_for": "2", "speaks_against": "3"}
    jsonschema.validate(texts | {"constants": {}}, reading_schema())
    with pytest.raises(jsonschema.ValidationError):
        jsonschema.validate(texts | {"constants": constants}, reading_schema())


def test_a_constant_that_was_added_later_is_left_out_at_its_old_value() -> None:
    """Specifications of older records, which lack the constant, then keep their digests."""
    old = [
        f"{section}.{key}={value}"
        for section, constants in ADDED_LATER.items()
        for key, value in constants.items()
    ]
    run = run_spec("neat", 0, *old)
    stated = run.without_seed()
    for section, constants in ADDED_LATER.items():
        assert not stated[section].keys() & constants.keys()
    assert complete(stated) == run.model_dump(mode="json", exclude={"seed"})
    assert RunSpec.model_validate_json(json.dumps(stated | {"seed": 0})) == run
    other = run_spec("neat", 0, *old, "neat.new_node_bias=drawn")
    assert other.without_seed()["neat"]["new_node_bias"] == "drawn"
    assert other.digest() != run.digest()
    assert other.trajectory_key() != run.trajectory_key()
