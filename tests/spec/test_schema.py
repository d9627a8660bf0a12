"""The JSON schemas by which editors check configuration files."""

import json

import jsonschema
import pytest

from neol.spec.configuration import CONFIG, budgets, configuration_schema
from neol.spec.plain_yaml import read_yaml


def test_the_schema_is_that_of_the_types():
    written = json.loads((CONFIG / "schema.json").read_text())
    assert written == configuration_schema(), "run `python -m neol.spec.configuration`"


@pytest.mark.parametrize("name", ["base", *budgets()])
def test_the_schema_accepts_the_files(name):
    path = CONFIG / f"{name}.yaml"
    assert path.read_text().startswith("# yaml-language-server: $schema=schema.json\n")
    jsonschema.validate(read_yaml(path, name), configuration_schema())


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
        jsonschema.validate(content, configuration_schema())
