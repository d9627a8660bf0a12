"""A run's specification: made from the configuration, its digests, refused values."""

import gymnasium
import pytest

from neol.spec.configuration import Configuration, load_configuration
from neol.spec.run_spec import RunSpec
from tests.helpers.refusal import refusal

DIGESTS = {
    "first": "943a5e4287029506895bbfb1974237c5999668edee9c117ce44952ac6765f6e0",
    "worked_example": "c30a6d79ab2f4ec00933059575169a66978895874cd3b2b12aa281a10b46b490",
}
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


@pytest.mark.parametrize("reading", DIGESTS)
def test_the_digest_is_known(reading):
    configuration = load_configuration("paper", reading=reading)
    assert configuration.run_spec(**RUN).digest() == DIGESTS[reading]


def test_stanleys_rule_needs_flags_that_are_not_redrawn():
    stanley = "neat.crossover_enabled=stanley"
    configuration = load_configuration("paper", [stanley])
    text = refusal(lambda: configuration.run_spec(**RUN))
    assert text.startswith(f"{stanley.replace('=', ' = ')}: needs neat.enabled_mutate_rate = 0, ")
    load_configuration("paper", [stanley, "neat.enabled_mutate_rate=0"]).run_spec(**RUN)


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
        ({"task": "gym:Blackjack-v1"}, "gym:Blackjack-v1: Gymnasium sets no step limit for it"),
        (
            {"task": "gym:Ant-v2"},
            'task "gym:Ant-v2": cannot be made: ImportError: The mujoco v2 and',
        ),
        ({"task": "gym:this:Env-v0"}, 'task "gym:this:Env-v0": no module is imported'),
        ({"task": "gym:"}, 'task "gym:": Malformed environment ID'),
        (
            {"method": "heb"},
            'unknown method "heb", did you mean "hebb"? (allowed: neat, neat_wo, hebb, oja, bcm, ',
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
        ({"method": "neat"}, "learning_rate = 0.25: neat does not learn online; leave it out"),
        ({"method": "neat_wo"}, "learning_rate = 0.25: neat_wo does not learn online"),
    ],
)
def test_a_run_that_is_not_allowed(paper, change, expected):
    assert refusal(paper.run_spec, **RUN | change).startswith(expected)


def test_an_environment_that_is_gone_is_refused_with_a_limit_too():
    expected = 'task "gym:Ant-v2": cannot be made: ImportError: The mujoco v2 and v3 based'
    text = refusal(load_configuration, "paper", ["tasks.gym:Ant-v2.max_steps=9"])
    assert text.startswith(expected)


def test_an_environment_that_cannot_be_made_is_refused(paper):
    def construct(**_settings):
        raise FileNotFoundError("no\ntrack")

    gymnasium.register("Trackless-v0", construct)
    try:
        text = refusal(paper.run_spec, **RUN | {"task": "gym:Trackless-v0"})
    finally:
        del gymnasium.registry["Trackless-v0"]
    assert text == 'task "gym:Trackless-v0": cannot be made: FileNotFoundError: no track'


def test_a_species_never_needs_more_than_the_population():
    configuration = load_configuration("paper", ["neat.min_species_size=51"])
    expected = "neat.min_species_size = 51: must not exceed the population, 50"
    assert refusal(configuration.run_spec, **RUN) == expected
