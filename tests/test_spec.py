import json
from pathlib import Path

import jsonschema
import pytest

from neol import spec
from neol.errors import UserError
from neol.plain_yaml import read_yaml
from neol.spec import CONFIG, Configuration, RunSpec, budgets, load_configuration, schema

DIGEST = "943a5e4287029506895bbfb1974237c5999668edee9c117ce44952ac6765f6e0"
RUN = {
    "task": "hopper",
    "method": "hebb",
    "population": 50,
    "learning_rate": 0.25,
    "generations": 3,
    "seed": 0,
}


@pytest.fixture(scope="module")
def paper() -> Configuration:
    return load_configuration("paper")


def message(call, *arguments, **keywords) -> str:
    with pytest.raises(UserError) as raised:
        call(*arguments, **keywords)
    text = str(raised.value)
    assert "\n" not in text
    return text


def test_the_paper_s_budget(paper):
    assert paper.budget.generations == 500
    assert paper.budget.seeds == 30
    assert paper.budget.populations == (50, 100, 200, 300)
    assert paper.budget.learning_rates == (2.5e-4, 2.5e-3, 2.5e-2, 2.5e-1)


@pytest.mark.parametrize("budget", ["smoke", "demo", "desk", "paper"])
def test_every_budget_can_be_run(budget):
    configuration = load_configuration(budget)
    assert configuration.budget.name == budget
    for task in configuration.budget.tasks:
        assert configuration.run_spec(**RUN | {"task": task}).task.name == task


def test_a_method_decides_rule_and_weight_mutation(paper):
    runs = {
        method: paper.run_spec(
            **RUN | {"method": method, "learning_rate": None if "neat" in method else 0.25}
        )
        for method in paper.budget.methods
    }
    assert {
        method: (run.plasticity.rule, run.neat.weight_mutation) for method, run in runs.items()
    } == {
        "neat": ("none", "config"),
        "neat_wo": ("none", "off"),
        "hebb": ("hebb", "off"),
        "oja": ("oja", "off"),
        "bcm": ("bcm", "off"),
    }
    assert runs["neat"].plasticity.learning_rate == 0
    assert runs["oja"].plasticity.learning_rate == 0.25


def test_a_specification_survives_json(paper):
    run = paper.run_spec(**RUN)
    again = RunSpec.model_validate_json(run.model_dump_json())
    assert again == run
    assert hash(again) == hash(run)
    assert again.digest() == run.digest()


def test_the_digest_forgets_the_seed_and_the_trajectory_key_the_generations(paper):
    run = paper.run_spec(**RUN)
    longer = paper.run_spec(**RUN | {"generations": 4})
    assert longer.digest() != run.digest()
    assert longer.trajectory_key() == run.trajectory_key()
    another = paper.run_spec(**RUN | {"seed": 1})
    assert another.digest() == run.digest()
    assert another.trajectory_key() != run.trajectory_key()
    for change in ({"population": 51}, {"learning_rate": 0.1}, {"method": "oja"}):
        other = paper.run_spec(**RUN | change)
        assert other.digest() != run.digest()
        assert other.trajectory_key() != run.trajectory_key()
    changed = load_configuration("paper", ["neat.elitism=1"]).run_spec(**RUN)
    assert changed.trajectory_key() != run.trajectory_key()


def test_the_digest_is_known(paper):
    assert paper.run_spec(**RUN).digest() == DIGEST


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


def test_any_gymnasium_environment_is_a_task():
    acrobot = load_configuration("smoke").run_spec(**RUN | {"task": "gym:Acrobot-v1"}).task
    assert acrobot.environment == "Acrobot-v1"
    assert acrobot.max_steps == 500
    assert acrobot.fresh_world
    capped = load_configuration("smoke", ["tasks.gym:Acrobot-v1.max_steps=7"])
    assert capped.run_spec(**RUN | {"task": "gym:Acrobot-v1"}).task.max_steps == 7


@pytest.mark.parametrize(
    ("change", "expected"),
    [
        ({"task": "hoper"}, 'unknown task "hoper", did you mean "hopper"? (allowed: cartpole, '),
        ({"task": "gym:Acrobat-v1"}, 'task "gym:Acrobat-v1": Environment `Acrobat` doesn\'t exist'),
        ({"task": "gym:Blackjack-v1"}, "gym:Blackjack-v1: Gymnasium sets it no limit of steps"),
        ({"task": "gym:Ant-v2"}, 'task "gym:Ant-v2": The mujoco v2 and v3 based environments have'),
        ({"task": "gym:this:Env-v0"}, 'task "gym:this:Env-v0": no module is imported'),
        ({"task": "gym:"}, 'task "gym:": Malformed environment ID'),
        (
            {"method": "heb"},
            'unknown method "heb", did you mean "hebb"? (allowed: neat, neat_wo, hebb, oja, bcm)',
        ),
        ({"population": 0}, "population = 0: must be greater than or equal to 2"),
        ({"population": 1}, "population = 1: must be greater than or equal to 2"),
        ({"population": 10**20}, "population = 100000000000000000000: must be less than or"),
        ({"population": 2.5}, "population = 2.5: must be a valid integer"),
        ({"generations": 0}, "generations = 0: must be greater than or equal to 1"),
        ({"seed": -1}, "seed = -1: must be greater than or equal to 0"),
        ({"learning_rate": -0.1}, "learning_rate = -0.1: must be greater than or equal to 0"),
        ({"learning_rate": float("nan")}, "learning_rate = nan: must be a finite number"),
        ({"learning_rate": None}, "hebb needs a learning rate (budget paper has 0.00025, "),
        ({"method": "neat"}, "learning_rate = 0.25: neat does not learn online, leave it out"),
        ({"method": "neat_wo"}, "learning_rate = 0.25: neat_wo does not learn online"),
    ],
)
def test_a_run_that_is_not_allowed(paper, change, expected):
    assert message(paper.run_spec, **RUN | change).startswith(expected)


def test_an_environment_that_is_gone_is_refused_with_a_limit_too():
    expected = 'task "gym:Ant-v2": The mujoco v2 and v3 based environments have been moved'
    text = message(load_configuration, "paper", ["tasks.gym:Ant-v2.max_steps=9"])
    assert text.startswith(expected)


def test_a_species_never_needs_more_than_the_population():
    configuration = load_configuration("paper", ["neat.min_species_size=51"])
    expected = "neat.min_species_size = 51: must not exceed the population, 50"
    assert message(configuration.run_spec, **RUN) == expected


@pytest.mark.parametrize("budget", ["smok", "base", "", "../config/smoke", "schema"])
def test_an_unknown_budget(budget):
    text = message(load_configuration, budget)
    assert text.startswith(f'unknown budget "{budget}"')
    assert text.endswith("(allowed: demo, desk, paper, smoke)")


@pytest.mark.parametrize(
    ("override", "expected"),
    [
        ("neat.elitsm=3", 'neat.elitsm: unknown key, did you mean "elitism"? (allowed: weight_'),
        ("neatt.elitism=3", 'neatt: unknown key, did you mean "neat"? (allowed: tasks, network, '),
        ("tasks.cartpole.steps=9", "tasks.cartpole.steps: unknown key"),
        ("tasks.cartpole.name=x", "tasks.cartpole.name: unknown key, it is called cartpole"),
        ("budget.name=x", "budget.name: unknown key, it is called smoke"),
        ("neat.elitism=x", "neat.elitism = 'x': must be a valid integer"),
        ("neat.elitism=1.5", "neat.elitism = 1.5: must be a valid integer"),
        ("neat.elitism=true", "neat.elitism = True: must be a valid integer"),
        ("neat.elitism=-1", "neat.elitism = -1: must be greater than or equal to 0"),
        ("budget.seeds=10001", "budget.seeds = 10001: must be less than or equal to 10000"),
        ("evaluation.episodes=1001", "evaluation.episodes = 1001: must be less than or equal to"),
        ("neat.elitism.x=3", "neat.elitism = {'x': 3}: must be a valid integer"),
        ("neat.elitism=2026-01-01", "neat.elitism = '2026-01-01': must be a valid integer"),
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
        ("budget.seeds_per_job=0", "budget.seeds_per_job = 0: must be an integer of at least 1"),
        ("budget.seeds_per_job={hopper: 3}", "budget.seeds_per_job: no number for cartpole"),
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
        ("budget.populations=50", "budget.populations = 50: must be a list"),
        ("budget.populations=[50, 1]", "budget.populations.1 = 1: must be greater than or equal"),
        ("budget.learning_rates=[-1]", "budget.learning_rates.0 = -1: must be greater than or"),
        ("budget.generations=0", "budget.generations = 0: must be an integer of at least 1"),
        ("budget.generations={hopper: 3}", "budget.generations: no number for cartpole"),
    ],
)
def test_an_override_that_is_not_allowed(override, expected):
    assert message(load_configuration, "smoke", [override]).startswith(f"--set: {expected}")


@pytest.mark.parametrize(
    ("override", "expected"),
    [
        ("neat.elitism", '--set "neat.elitism": write it as key=value, like neat.elitism=3'),
        ("=3", '--set "=3": write it as key=value, like neat.elitism=3'),
        ("neat..elitism=3", '--set "neat..elitism=3": write it as key=value'),
        ("neat.elitism=[1", "--set neat.elitism=[1, line 1: expected ',' or ']'"),
        ("neat={a: 1, a: 2}", '--set neat={a: 1, a: 2}, line 1: key "a" stands here a second'),
        ("neat.elitism=!!python/name:os.system", "--set neat.elitism=!!python/name:os.system"),
    ],
)
def test_an_override_that_cannot_be_read(override, expected):
    assert message(load_configuration, "smoke", [override]).startswith(expected)


@pytest.fixture
def config(tmp_path, monkeypatch) -> Path:
    """A copy of the configuration's folder, to break."""
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
            'config/mine.yaml, line 3: key "elitism" stands here a second time',
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
    assert message(load_configuration, "mine").startswith(expected)


def test_a_file_that_is_no_text(config):
    (config / "mine.yaml").write_bytes(b"\xff\xfe\x00")
    assert message(load_configuration, "mine").startswith("config/mine.yaml: cannot be read (")


def test_a_constant_missing_from_the_base(config):
    base = config / "base.yaml"
    base.write_text(base.read_text().replace("  sum_limit: 50.0", "  #"))
    assert message(load_configuration, "smoke").endswith("network.sum_limit: is missing")


def test_the_schema_is_that_of_the_types():
    written = json.loads((CONFIG / "schema.json").read_text())
    assert written == schema(), "run `python -m neol.spec`"


@pytest.mark.parametrize("name", ["base", *budgets()])
def test_the_schema_accepts_the_files(name):
    path = CONFIG / f"{name}.yaml"
    assert path.read_text().startswith("# yaml-language-server: $schema=schema.json\n")
    jsonschema.validate(read_yaml(path, name), schema())


@pytest.mark.parametrize(
    "content",
    [
        {"neet": {}},
        {"neat": {"elitsm": 3}},
        {"neat": {"elitism": -1}},
        {"neat": {"elitism": "3"}},
        {"methods": {"sgd": {}}},
        {"methods": {"hebb": {"weight_mutation": 1.5}}},
        {"budget": {"name": "mine"}},
        {"budget": {"populations": [50, 50]}},
        {"tasks": {"cartpole": {"name": "cartpole"}}},
    ],
)
def test_the_schema_refuses_what_the_types_refuse(content):
    with pytest.raises(jsonschema.ValidationError):
        jsonschema.validate(content, schema())


def test_every_constant_of_the_base_has_its_source():
    """A comment on each line that gives a value."""
    for line in (CONFIG / "base.yaml").read_text().splitlines():
        key, _, value = line.partition(": ")
        if value.strip() and not key.startswith("#") and "hardcore" not in key:
            assert " # " in line or key.strip() == "fresh_world", line
