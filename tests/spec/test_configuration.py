"""A budget's configuration: base, file and overrides; refused values and their places."""

import re
import shutil
from pathlib import Path

import pytest

from neol.spec import configuration as spec
from neol.spec.configuration import CONFIG, load_configuration
from neol.spec.readings import read_reading
from tests.helpers.refusal import refusal


def test_overrides_come_last():
    configuration = load_configuration(
        "smoke",
        [
            "neat.elitism=3",
            "plasticity.reward_scale=1e-1",
            "tasks.cartpole.max_steps=200",
            "methods.hebb.weight_mutation=0.3",
            "methods.neat.weight_mutation=off",
            "evaluation.step_limit=null",
            "neat.elitism=4",
        ],
    )
    assert configuration.neat.elitism == 4
    assert configuration.plasticity.reward_scale == 0.1
    assert configuration.tasks["cartpole"].max_steps == 200
    assert configuration.methods["hebb"].weight_mutation == 0.3
    assert configuration.methods["neat"].weight_mutation == "off"
    assert configuration.evaluation.step_limit is None


def test_the_seeds_of_a_budget_begin_at_0_or_where_they_are_said_to() -> None:
    plain = load_configuration("smoke", ["budget.seeds=3"]).budget
    assert plain.seeds_of("cartpole") == range(3)
    chosen = load_configuration("smoke", ["budget.seeds={first: 1000000, count: 5}"]).budget
    assert chosen.seeds_of("cartpole") == range(1_000_000, 1_000_005)


def test_tasks_may_have_their_own_seeds_and_populations() -> None:
    overrides = [
        "budget.tasks=[cartpole, hopper]",
        "budget.seeds={cartpole: 4, hopper: 2}",
        "budget.populations={cartpole: [6, 12], hopper: [8]}",
    ]
    budget = load_configuration("smoke", overrides).budget
    assert [len(budget.seeds_of(task)) for task in budget.tasks] == [4, 2]
    assert [budget.populations_of(task) for task in budget.tasks] == [(6, 12), (8,)]


@pytest.mark.parametrize("budget", ["smok", "base", "", "../config/smoke", "schema"])
def test_an_unknown_budget(budget):
    text = refusal(load_configuration, budget)
    assert text.startswith(f'unknown budget "{budget}"')
    assert text.endswith(
        "(allowed: confirmation, demo, desk, evidence, multiverse, paper, search, smoke, "
        "two_by_two, PATH.yaml)"
    )


@pytest.mark.parametrize(
    ("override", "expected"),
    [
        ("neat.elitsm=3", 'neat.elitsm: unknown key, did you mean "elitism"? (allowed: weight_'),
        ("neatt.elitism=3", 'neatt: unknown key, did you mean "neat"? (allowed: tasks, network, '),
        ("tasks.cartpole.steps=9", "tasks.cartpole.steps: unknown key"),
        ("tasks.cartpole.name=x", "tasks.cartpole.name: unknown key; the name is cartpole"),
        ("budget.name=x", "budget.name: unknown key; the name is smoke"),
        ("neat.elitism=x", "neat.elitism = 'x': must be a valid integer"),
        ("neat.elitism=1.5", "neat.elitism = 1.5: must be a valid integer"),
        ("neat.elitism=true", "neat.elitism = True: must be a valid integer"),
        ("neat.elitism=-1", "neat.elitism = -1: must be greater than or equal to 0"),
        ("budget.seeds=10001", "budget.seeds = 10001: must be a number of seeds from 1 to 10000, "),
        ("budget.seeds={first: 5}", 'budget.seeds: unknown task "first"'),
        ("budget.records_of={hoper: desk}", 'budget.records_of: unknown task "hoper", did you'),
        ("budget.records_of={hopper: dsk}", 'budget.records_of: unknown budget "dsk", did you'),
        ("evaluation.episodes=1001", "evaluation.episodes = 1001: must be less than or equal to"),
        ("neat.elitism=9007199254740993", "neat.elitism = 9007199254740993: must be less than or"),
        (
            "tasks.cartpole.max_steps=99999999999999999999999",
            "tasks.cartpole.max_steps = 99999999999999999999999: must be less than or equal to",
        ),
        ("neat.elitism.x=3", "neat.elitism = {'x': 3}: must be a valid integer"),
        ("neat=3", "neat = 3: must be a mapping of keys to values"),
        ("tasks=3", "tasks = 3: must be a mapping of keys to values"),
        ("tasks.cartpole=3", "tasks.cartpole = 3: must be a mapping of keys to values"),
        ("budget=null", "budget = None: must be a mapping of keys to values"),
        ("plasticity.write_back=yes", "plasticity.write_back = 'yes': must be a valid boolean"),
        ("plasticity.reward_scale=0", "plasticity.reward_scale = 0: must be greater than 0"),
        ("plasticity.reward_scale=1e999", "plasticity.reward_scale = inf: must be a finite"),
        ("plasticity.threshold_rate=2", "plasticity.threshold_rate = 2: must be less than or"),
        ("tasks.cartpole.environment=this:Env", "tasks.cartpole.environment = 'this:Env'"),
        ("evaluation.episodes=0", "evaluation.episodes = 0: must be greater than or equal to 1"),
        ("evaluation.step_limit=0", "evaluation.step_limit = 0: must be greater than or equal"),
        ("budget.seeds_per_job=0", "budget.seeds_per_job = 0: must be an integer from 1 to 2^53"),
        ("budget.seeds_per_job={hopper: 3}", "budget.seeds_per_job: no value for cartpole"),
        ("network.hidden_activation=sin", "network.hidden_activation = 'sin': must be 'tanh', "),
        (
            "methods.hebb.weight_mutation=1.5",
            "methods.hebb.weight_mutation = 1.5: must be 'off', 'config' or a probability",
        ),
        ("methods.sgd.rule=hebb", "methods.sgd = 'sgd': must be 'neat', 'neat_wo', 'hebb', "),
        ("tasks.mine.max_steps=3", "tasks.mine.environment: is missing"),
        (
            "budget.tasks=[carpole]",
            'budget.tasks: unknown task "carpole", did you mean "cartpole"? (allowed: cartpole,',
        ),
        ("budget.tasks=[hopper, hopper]", "budget.tasks = ['hopper', 'hopper']: must not name a"),
        ("budget.tasks=[]", "budget.tasks = []: must not be empty"),
        (
            "budget.populations=50",
            "budget.populations = 50: must be a list of different population",
        ),
        ("budget.populations=[50, 1]", "budget.populations = [50, 1]: must be a list of different"),
        ("budget.populations={hopper: [50]}", "budget.populations: no value for cartpole"),
        ("budget.seeds={hopper: 3}", "budget.seeds: no value for cartpole"),
        ("budget.seeds={hopper: 0}", "budget.seeds = {'hopper': 0}: must be a number of seeds"),
        ("budget.learning_rates=[-1]", "budget.learning_rates.0 = -1: must be greater than or"),
        ("budget.generations=0", "budget.generations = 0: must be an integer from 1 to 2^53"),
        ("budget.generations=9007199254740993", "budget.generations = 9007199254740993: must be"),
        ("budget.generations={hopper: 3}", "budget.generations: no value for cartpole"),
        ("budget.configurations={hopper: grid}", "budget.configurations: no value for cartpole"),
        ("budget.configurations=some", "budget.configurations = 'some': must be 'grid', 'tables'"),
    ],
)
def test_an_override_that_is_not_allowed(override, expected):
    assert refusal(load_configuration, "smoke", [override]).startswith(f"--set: {expected}")


@pytest.mark.parametrize(
    ("override", "expected"),
    [
        ("neat.elitism", '--set "neat.elitism": write it as key=value, like neat.elitism=3'),
        ("=3", '--set "=3": write it as key=value, like neat.elitism=3'),
        ("neat..elitism=3", '--set "neat..elitism=3": write it as key=value'),
        ("neat.elitism=[1", "--set neat.elitism=[1, line 1: expected ',' or ']'"),
        ("neat={a: 1, a: 2}", '--set neat={a: 1, a: 2}, line 1: found duplicate key "a"'),
        ("neat.elitism=2026-01-01", "--set neat.elitism=2026-01-01, line 1: tag:yaml.org,2002:t"),
        ("neat.elitism=!!python/name:os.system", "--set neat.elitism=!!python/name:os.system"),
    ],
)
def test_an_override_that_cannot_be_read(override, expected):
    assert refusal(load_configuration, "smoke", [override]).startswith(expected)


@pytest.fixture
def config(tmp_path, monkeypatch) -> Path:
    """Copy the configuration's folder, so that a test can break it."""
    folder = tmp_path / "config"
    folder.mkdir()
    for path in CONFIG.glob("*.yaml"):
        (folder / path.name).write_text(path.read_text())
    monkeypatch.setattr(spec, "CONFIG", folder)
    return folder


@pytest.mark.parametrize(
    ("content", "expected"),
    [
        ("", "config/mine.yaml: must be a mapping of keys to values"),
        ("- 3", "config/mine.yaml: must be a mapping of keys to values"),
        ("neat: [1", "config/mine.yaml, line 1: expected ',' or ']', but got '<stream end>'"),
        (
            "neat:\n  elitism: 2\n  elitism: 3\n",
            'config/mine.yaml, line 3: found duplicate key "elitism"',
        ),
        ("neat:\n  elitism: off\n", "config/mine.yaml: neat.elitism = 'off': must be a valid "),
        ("neat:\n  elitsm: 3\n", 'config/mine.yaml: neat.elitsm: unknown key, did you mean "'),
        ("3: 4\n", "config/mine.yaml: 3: unknown key (allowed: tasks, "),
        ("neat: {}\n", "config/mine.yaml: budget: is missing"),
        ("budget: {seeds: 3}\n", "config/mine.yaml: budget.generations: is missing"),
        ("a\x00b: 1\n", "config/mine.yaml: unacceptable character #x0000"),
    ],
)
def test_a_file_that_is_not_allowed(config, content, expected):
    (config / "mine.yaml").write_text(content)
    assert refusal(load_configuration, "mine").startswith(expected)


def test_a_file_that_is_no_text(config):
    (config / "mine.yaml").write_bytes(b"\xff\xfe\x00")
    assert refusal(load_configuration, "mine").startswith("config/mine.yaml: cannot be read (")


def test_a_file_beside_the_user_has_its_bare_name(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    Path("mine.yaml").write_text("neat: [1")
    assert refusal(load_configuration, "mine.yaml").startswith("mine.yaml, line 1: expected")
    Path("loop.yaml").symlink_to("loop.yaml")
    assert refusal(load_configuration, "loop.yaml").startswith("loop.yaml: ")


def test_a_constant_missing_from_the_base(config):
    base = config / "base.yaml"
    base.write_text(base.read_text().replace("  sum_limit: 50.0", "  #"))
    assert refusal(load_configuration, "smoke").endswith("network.sum_limit: is missing")


def test_every_constant_of_the_base_has_its_source():
    """Check that each line with a value has a comment."""
    for line in (CONFIG / "base.yaml").read_text().splitlines():
        key, _, value = line.partition(": ")
        if value.strip() and not key.startswith("#") and "hardcore" not in key:
            assert " # " in line or key.strip() == "fresh_world", line


@pytest.mark.parametrize("name", ["x$(touch PWNED)y", "../../../x", "it's", "a b", "-x", ".."])
def test_a_name_that_a_shell_or_a_path_would_read_otherwise(name: str) -> None:
    task = "{environment: CartPole-v1, max_steps: 5, fresh_world: false}"
    text = refusal(load_configuration, "smoke", [f'tasks={{"{name}": {task}}}'])
    assert "must be a name of at most 100 letters, digits and _ . + -" in text
    text = refusal(load_configuration, "smoke", [f'budget.tasks=["{name}"]'])
    assert "must be a name of at most 100 letters, digits and _ . + -" in text
    text = refusal(load_configuration, "smoke", [f'tasks.cartpole.environment="{name}"'])
    assert "must be Gymnasium's ID of an environment" in text


def test_a_reading_whose_files_name_cannot_be_part_of_a_path(tmp_path: Path) -> None:
    (tmp_path / "x$(touch PWNED)y.yaml").touch()
    text = refusal(read_reading, tmp_path, "x$(touch PWNED)y")
    assert "cannot be part of a path; name it with letters" in text


def test_a_method_of_the_budget_without_constants(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    shutil.copytree(CONFIG, tmp_path / "config")
    monkeypatch.setattr(spec, "CONFIG", tmp_path / "config")
    base = tmp_path / "config" / "base.yaml"
    base.write_text(re.sub(r"\n  neat_wo: .*", "", base.read_text()))
    assert 'budget.methods: no constants for "neat_wo"' in refusal(load_configuration, "smoke")
