"""Base class of everything that is read from a file, and the types of its fields."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Annotated, Any, Literal, LiteralString, TypeVar

from pydantic import (
    AfterValidator,
    BaseModel,
    ConfigDict,
    Field,
    GetCoreSchemaHandler,
    GetJsonSchemaHandler,
    ValidationError,
    ValidatorFunctionWrapHandler,
    WrapValidator,
)
from pydantic_core import CoreSchema, PydanticCustomError, core_schema

from neol.network.rules import NO_RULE, RULES, method_names


class Model(BaseModel):
    """Immutable data with strict types, known keys and finite numbers only."""

    model_config = ConfigDict(
        frozen=True,
        extra="forbid",
        strict=True,
        allow_inf_nan=False,
        use_attribute_docstrings=True,
    )


Probability = Annotated[float, Field(ge=0, le=1)]
_LARGEST = 2**53  # compiled loops count this far, and every reader of JSON stores it exactly
PositiveInt = Annotated[int, Field(ge=1, le=_LARGEST)]
NonNegativeInt = Annotated[int, Field(ge=0, le=_LARGEST)]
LARGEST_SEED = 2**63 - 1  # the largest integer of a record's column
Seed = Annotated[int, Field(ge=0, le=LARGEST_SEED)]
PositiveFloat = Annotated[float, Field(gt=0)]
NonNegativeFloat = Annotated[float, Field(ge=0)]
PopulationSize = Annotated[int, Field(ge=2, le=100_000)]  # a typing error must not fill the memory
Sha256 = Annotated[str, Field(pattern="^[0-9a-f]{64}$")]
Text = Annotated[str, Field(min_length=1)]
Item = TypeVar("Item")


def _distinct(values: tuple[Item, ...]) -> tuple[Item, ...]:
    if len(set(values)) < len(values):
        raise PydanticCustomError("distinct", "must not name a value twice")
    return values


Several = Annotated[
    tuple[Item, ...],
    Field(min_length=1, json_schema_extra={"uniqueItems": True}),
    AfterValidator(_distinct),
]


@dataclass(frozen=True, slots=True)
class _OneOf:
    """Check that a string is one of some names, read at each check because rules may be added."""

    names: Callable[[], Sequence[str]]

    def __get_pydantic_core_schema__(
        self, source: Any, handler: GetCoreSchemaHandler
    ) -> CoreSchema:
        return core_schema.no_info_after_validator_function(self._check, handler(source))

    def __get_pydantic_json_schema__(
        self, schema: CoreSchema, handler: GetJsonSchemaHandler
    ) -> dict[str, Any]:
        return {**handler(schema), "enum": list(self.names())}

    def _check(self, value: str) -> str:
        *most, last = map(repr, self.names())
        if value not in self.names():
            raise PydanticCustomError(
                "one_of", "must be {most} or {last}", {"most": ", ".join(most), "last": last}
            )
        return value


RuleName = Annotated[str, _OneOf(lambda: [NO_RULE, *RULES])]
MethodName = Annotated[str, _OneOf(method_names)]


def _in_words(sentence: LiteralString) -> WrapValidator:
    """Replace pydantic's pattern or list of union members by one sentence on what is allowed."""

    def check(value: Any, validate: ValidatorFunctionWrapHandler) -> Any:
        try:
            return validate(value)
        except ValidationError:
            raise PydanticCustomError("in_words", sentence) from None

    return WrapValidator(check)


NAME = r"\w[\w.+-]*"
"""A name in paths and commands: no slash, space, quote or dollar; no dot or dash first."""
Name = Annotated[
    str,
    Field(pattern=f"^{NAME}$", max_length=100),
    _in_words("must be a name of at most 100 letters, digits and _ . + -, a letter or digit first"),
]
TaskName = Annotated[
    str,
    Field(pattern=f"^(gym:({NAME}/)?)?{NAME}$", max_length=100),
    _in_words(
        "must be a name of at most 100 letters, digits and _ . + -, a letter or digit first, "
        "or gym:ID"
    ),
]
EnvironmentName = Annotated[
    str,
    Field(pattern=f"^({NAME}/)?{NAME}$", max_length=100),
    _in_words("must be Gymnasium's ID of an environment, without a module"),
]
Label = Annotated[str, Field(pattern=rf"^{NAME}(=[\w.+=-]*)?$", max_length=1000)]
"""A reading's name, followed by changed constants (see neol.spec.readings)."""
WeightMutation = Annotated[
    Literal["off", "config"] | Probability,
    _in_words("must be 'off', 'config' or a probability from 0 to 1"),
]
SeedCount = Annotated[int, Field(ge=1, le=10_000)]


class SeedRange(Model):
    """Consecutive seeds."""

    first: Annotated[int, Field(ge=0, le=2**62)]
    count: SeedCount


Seeds = Annotated[
    SeedCount | SeedRange | dict[Text, SeedCount],
    Field(union_mode="left_to_right"),
    _in_words(
        "must be a number of seeds from 1 to 10000, such a number for each task, or like "
        "{first: 1000, count: 10}"
    ),
]
_Sizes = Annotated[Several[PopulationSize], Field(strict=False)]  # a list is no strict tuple
Populations = Annotated[
    _Sizes | dict[Text, _Sizes],
    _in_words(
        "must be a list of different population sizes from 2 to 100000, or such a list for each "
        "task"
    ),
]
ForEachTask = Annotated[
    PositiveInt | dict[Text, PositiveInt],
    _in_words("must be an integer from 1 to 2^53, or such an integer for each task"),
]
PartOfGrid = Literal["grid", "tables", "table4"]
PartsOfGrids = Annotated[
    PartOfGrid | dict[Text, PartOfGrid],
    _in_words("must be 'grid', 'tables' or 'table4', or one of these for each task"),
]
