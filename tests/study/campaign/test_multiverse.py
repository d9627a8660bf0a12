"""The multiverse: its readings, which runs they share, and the calls that make them."""

from pathlib import Path

import pytest

from neol.spec.configuration import load_configuration
from neol.study.campaign import multiverse
from neol.study.campaign.grid import run_specs
from neol.study.campaign.multiverse import (
    BUDGET,
    Universe,
    calls,
    choices,
    configuration,
    method_blocks,
    universes,
)
from tests.helpers.refusal import refusal
from tests.helpers.runs import evolve, run_spec


def test_the_first_reading_is_the_worked_example_and_all_differ() -> None:
    every = universes()
    assert len(every) == len({tuple(each.values()) for each in every}) == 32
    methods = load_configuration(BUDGET).budget.methods
    assert {configuration(every[0], method).reading for method in methods} == {"worked_example"}


def constants(universe: Universe, method: str) -> str:
    """The specification of a method's runs on CartPole."""
    block = method_blocks(universe, method)[0]
    return run_specs(configuration(universe, method), block)[0].digest()


@pytest.mark.parametrize(("method", "specifications"), [("neat", 16), ("neat_wo", 8), ("hebb", 16)])
def test_a_method_has_as_many_specifications_as_what_concerns_it_has_combinations(
    method: str, specifications: int
) -> None:
    assert len({constants(universe, method) for universe in universes()}) == specifications


def test_what_does_not_concern_a_method_would_not_change_its_runs() -> None:
    """Beta does not act on a method without a rule; NEAT's mutation is a constant of NEAT alone."""
    found = choices()
    concerned = {name: set(choice.methods) for name, choice in found.items()}
    every = set(load_configuration(BUDGET).budget.methods)
    assert every - concerned.pop("beta") == {"neat", "neat_wo"}
    assert concerned.pop("NEAT's mutation") == {"neat"}
    assert all(methods == every for methods in concerned.values())
    (beta,) = found["beta"].options["0.1"]
    assert evolve(run_spec("neat", 0, beta)).state.history == evolve(run_spec("neat")).state.history
    (mutation,) = found["NEAT's mutation"].options["a tenth"]
    assert run_spec("hebb", 0, mutation) == run_spec("hebb")
    assert run_spec("neat_wo", 0, mutation) == run_spec("neat_wo")


def test_calls_make_each_record_once() -> None:
    lines = calls()
    records = [word for line in lines for word in line.split() if word.endswith(".parquet")]
    assert len(records) == len(set(records)) == 2 * 2 * (16 + 8 + 3 * 16)
    assert lines[0].endswith("--config budget=multiverse reading=worked_example")
    for line in lines:
        reading = line.split()[-1].removeprefix("reading=")
        assert {Path(word).parts[1] for word in line.split() if "/" in word} == {reading}
    assert max(len(Path(record).parts[1]) for record in records) < 255, "a folder's longest name"


@pytest.mark.parametrize(
    ("content", "expected"),
    [
        ("beta: {methods: [hebb]}", "search/mine.yaml: beta.options: is missing"),
        (
            "beta: {methods: [heb], options: {one: []}}",
            "search/mine.yaml: beta.methods.0 = 'heb': must be ",
        ),
        (
            "beta: {methods: [hebb], options: {one: [plasticity.beta=1]}}",
            "search/mine.yaml: --reading: plasticity.beta: unknown key",
        ),
        (
            "beta: {methods: [hebb], options: {one: [budget.seeds=1]}}",
            'search/mine.yaml: "budget.seeds=1": a reading sets no budget',
        ),
    ],
)
def test_a_grid_that_is_not_allowed(
    content: str, expected: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    path = tmp_path / "search" / "mine.yaml"
    path.parent.mkdir()
    path.write_text(content)
    monkeypatch.setattr(multiverse, "GRID", path)
    assert refusal(calls).startswith(expected)
