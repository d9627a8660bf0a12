"""The questions that the paper's claims raise: paper/questions.yaml and paper/claims.yaml.

A claim is a quote and the questions that it raises. A question says what is compared with what and
which answer the paper gives; it is the unit that is judged and counted.
"""

import json
from collections import Counter
from pathlib import Path
from typing import Annotated, Literal, TypeVar

from pydantic import Field, ValidationError

from neol.base.errors import UserError
from neol.spec.configuration import ROOT
from neol.spec.plain_yaml import read_yaml
from neol.spec.types import Model, PositiveFloat, Several
from neol.study.claims.effect import Scale, Statistic
from neol.study.outcomes.outcomes import Metric

CLAIMS = ROOT / "paper" / "claims.yaml"
QUESTIONS = ROOT / "paper" / "questions.yaml"

Method = Literal["bcm", "hebb", "oja", "neat", "neat_wo"]
Rule = Literal["bcm", "hebb", "oja"]
RULES: tuple[Rule, ...] = ("bcm", "hebb", "oja")
MAIN_FAMILIES = ("fitness", "SCORE", "spread")
"""Families of the paper's main claims: the rules end higher, sooner and with less variation."""
Cells = Literal["table3", "table4", "largest", "best", "grid"]
"""Cells that represent a method: those of the paper's Table 3 or 4; the best cell on even seeds, of
the largest population or of the whole grid; or the whole grid."""
Expect = Literal["higher", "lower", "equal", "not_lower"]
"""The paper's statement about the first side of a comparison."""


class Side(Model):
    """One side of a comparison."""

    cells: Cells
    method: Method | None = None
    """The method; None for the rule of the part."""
    populations: Several[int] | None = None
    learning_rates: Several[float] | None = None
    """Restrictions of the grid."""


class _Question(Model):
    id: str
    ask: str
    """The question in words."""
    family: str | None = None
    """Questions that Holm's correction puts together; None where nothing is tested."""
    by_construction: str | None = None
    """Reason why the answer is known without any run."""
    tasks: Several[str]


class Difference(_Question):
    """One side's mean (or spread) minus the other's, averaged over the tasks."""

    kind: Literal["difference"]
    outcome: Metric
    statistic: Statistic = "mean"
    scale: Scale = "raw"
    expect: Expect
    margin: PositiveFloat = 0.5
    """Differences below it count as none.

    Its unit is the standard deviation of the paper's baseline (raw) or of a run (sd), a logarithm
    (spread), or a share (relative).
    """
    rules: Several[Rule] = RULES
    """Rules, each of which is a part on each task."""
    side: Side
    against: Side
    than_tasks: tuple[str, ...] = ()
    """Tasks whose average is subtracted from that of `tasks`."""


class Interaction(_Question):
    """The effect of a rule with weight mutation minus its effect without it."""

    kind: Literal["interaction"]
    outcome: Metric
    expect: Expect
    margin: PositiveFloat = 0.5
    rules: Several[Rule] = RULES


class Sensitivity(_Question):
    """Variation of a rule's mean between learning rates, compared with other rules'."""

    kind: Literal["sensitivity"]
    outcome: Metric
    expect: Expect
    rule: Rule
    than: Several[Rule]


class Placing(Model):
    """A rule is among the best `at_most` methods."""

    rule: Rule
    at_most: Annotated[int, Field(ge=1, le=2)]


class Rank(_Question):
    """On each task a rule is among the best of the three rules and a baseline."""

    kind: Literal["rank"]
    outcome: Metric
    cells: Cells
    ranks: dict[str, Placing]
    """The expected placing on each task."""
    against: Method


class Ceiling(_Question):
    """Runs of every method end at the task's maximum."""

    kind: Literal["ceiling"]
    level: float
    share: Annotated[float, Field(gt=0, lt=1)]
    """Share of the runs that must end there."""


class Printed(_Question):
    """Our means are those that the paper prints."""

    kind: Literal["printed"]


Question = Annotated[
    Difference | Interaction | Sensitivity | Rank | Ceiling | Printed, Field(discriminator="kind")
]


class Claim(Model):
    """A sentence of the paper, its place, and the questions that it raises."""

    id: str
    place: str
    quote: str
    questions: Several[str]
    note: str | None = None
    """Contradiction within the paper itself."""


class _Questions(Model):
    questions: tuple[Question, ...]


class _Claims(Model):
    claims: tuple[Claim, ...]


File = TypeVar("File", _Questions, _Claims)


def load_questions(path: Path = QUESTIONS) -> tuple[Question, ...]:
    """Read all questions. Raises UserError for what is wrong in the file."""
    questions = _read(path, _Questions).questions
    _distinct(path, [question.id for question in questions])
    return questions


def main_questions() -> list[Difference]:
    """Return the questions of the main claims, each on one task against one baseline."""
    return [
        question
        for question in load_questions()
        if isinstance(question, Difference) and question.family in MAIN_FAMILIES
    ]


def load_claims(path: Path = CLAIMS, questions: Path = QUESTIONS) -> tuple[Claim, ...]:
    """Read all claims. Raises UserError for what is wrong in a file."""
    claims = _read(path, _Claims).claims
    _distinct(path, [claim.id for claim in claims])
    known = {question.id for question in load_questions(questions)}
    for claim in claims:
        for name in claim.questions:
            if name not in known:
                raise UserError(f'{path.name}: {claim.id}: there is no question "{name}"')
    return claims


def _read(path: Path, content: type[File]) -> File:
    try:
        return content.model_validate_json(json.dumps(read_yaml(path, path.name)))
    except ValidationError as error:
        first = error.errors()[0]
        place = ".".join(map(str, first["loc"]))
        raise UserError(f"{path.name}: {place}: {first['msg']}") from None


def _distinct(path: Path, names: list[str]) -> None:
    twice = [name for name, count in Counter(names).items() if count > 1]
    if twice:
        raise UserError(f'{path.name}: two entries are called "{twice[0]}"')
