"""Added rules: which are refused, and that only a rule's current version is played."""

import importlib
import sys
from collections.abc import Iterator
from pathlib import Path

import numpy as np
import pytest

from neol.base.errors import UserError
from neol.network.plasticity import Learning, compiled, learn, learner
from neol.network.rules import RULES, rule
from neol.spec.configuration import Configuration, configuration_schema, load_configuration
from tests.helpers.networks import one_node


@pytest.fixture(autouse=True)
def _rules() -> Iterator[None]:
    """Remove the rules that a test has added."""
    before = dict(RULES)
    yield
    RULES.clear()
    RULES.update(before)


def leaky(x: float, y: float, w: float, theta: float) -> float:
    """Hebb's rule, leaking.

    More of it.
    """
    return x * y - 0.5 * w


def learned(name: str) -> float:
    """Return a weight of 2 after one step with x = 1, y = 0.5 and gate 1."""
    weight = np.array([2.0])
    learning = Learning(compiled(name), 1.0, 0.1, 10.0, np.zeros(1))
    learn(one_node(weight), 0, learning, 1.0, np.array([1.0, 0.5]))
    return float(weight[0])


def refusal(change) -> str:  # type: ignore[no-untyped-def]
    before = dict(RULES)
    with pytest.raises(UserError) as raised:
        rule(change)
    assert before == RULES
    return str(raised.value)


def test_a_rule_is_known_everywhere_at_once() -> None:
    before = load_configuration("smoke")
    assert rule(leaky) is leaky
    assert (RULES["leaky"].name, RULES["leaky"].meaning) == ("leaky", "Hebb's rule, leaking.")
    assert learned("leaky") == 2.0 + 0.5 - 1.0
    configuration = load_configuration("smoke", ["budget.methods=[leaky, bcm]"])
    assert list(configuration.methods) == [*before.methods, "leaky", "leaky_mutated"]
    assert configuration.budget.methods == ("leaky", "bcm")
    assert configuration.methods["leaky"].weight_mutation == "off"
    both = configuration.methods["leaky_mutated"]
    assert (both.rule, both.weight_mutation) == ("leaky", "config")
    definitions = configuration_schema()["$defs"]
    assert definitions["Method"]["properties"]["rule"]["enum"][-1] == "leaky"
    named = definitions["Budget"]["properties"]["methods"]["items"]["enum"]
    assert {"leaky", "leaky_mutated"} <= set(named)


def test_the_configuration_may_say_otherwise() -> None:
    rule(leaky)
    changed = load_configuration("smoke", ["methods.leaky.weight_mutation=config"])
    assert changed.methods["leaky"].rule == "leaky"
    assert changed.methods["leaky"].weight_mutation == "config"


def test_a_record_of_a_rule_that_is_not_here_is_read_but_not_played() -> None:
    rule(leaky)
    configuration: Configuration = load_configuration("smoke")
    spec = configuration.run_spec(
        task="cartpole",
        method="leaky",
        population=6,
        learning_rate=0.1,
        generations=1,
        seed=0,
    )
    del RULES["leaky"]
    again = type(spec).model_validate_json(spec.model_dump_json())
    assert again == spec
    with pytest.raises(UserError, match=r'unknown rule "leaky" \(allowed: hebb, .* run "python SC'):
        compiled(again.plasticity.rule)


def test_a_rule_that_runs_again_replaces_itself() -> None:
    rule(leaky)
    assert learned("leaky") == 1.5

    def faster(x: float, y: float, w: float, theta: float) -> float:
        return x * y - 0.75 * w

    faster.__name__ = "leaky"
    rule(faster)
    assert learned("leaky") == 1.0


def test_an_edited_module_is_compiled_anew(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.syspath_prepend(tmp_path)
    monkeypatch.setattr(sys, "dont_write_bytecode", True)
    file = tmp_path / "rule_of_a_test.py"
    text = "import neol\n@neol.rule\ndef decay(x, y, w, theta):\n    return -RATE * w\n"
    file.write_text("RATE = 0.25\n" + text)
    module = importlib.import_module("rule_of_a_test")
    assert learned("decay") == 1.5
    file.write_text("RATE = 0.5\n" + text)
    importlib.reload(module)
    assert learned("decay") == 1.0


def test_the_package_s_own_rules_come_from_the_cache() -> None:
    for known in RULES.values():
        learner(known)  # in the cache from now on
        assert learner.__wrapped__(known).cache_hits == 1


def test_what_cannot_be_a_rule() -> None:
    assert "rule two: must be a function of (x, y, w, theta)" in refusal(two)
    assert "rule <lambda>: its name must be lower case" in refusal(lambda x, y, w, theta: x)
    assert "rule hebb: the name is taken" in refusal(named("hebb"))
    for name in ("none", "neat", "neat_wo"):
        assert f"rule {name}: the name is taken" in refusal(named(name))
    assert "rule my_mutated: its name must not end in _mutated" in refusal(named("my_mutated"))


def two(x: float, y: float) -> float:
    return x * y


def named(name: str):  # type: ignore[no-untyped-def]
    def change(x: float, y: float, w: float, theta: float) -> float:
        return x

    change.__name__ = name
    return change


def test_a_rule_that_does_not_compile() -> None:
    @rule
    def wordy(x: float, y: float, w: float, theta: float) -> float:
        return x + "a"  # type: ignore[operator,no-any-return]

    with pytest.raises(UserError, match=r"^rule wordy: numba cannot compile it; numba\.njit"):
        compiled("wordy")
    assert RULES["wordy"].meaning == ""
