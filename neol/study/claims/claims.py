"""The ledger of the paper's claims: paper/claims.yaml, decided on a budget's runs.

A claim is right if all its parts are. A part's effect is signed so that the claim says "above 0":

- supported: the effect's 95% interval (stratified bootstrap) lies above 0; a claim of significance:
  the one-sided rank-sum test has p < 0.05.
- contradicted: the interval lies at or below 0, the test is significant the other way round. As
  one part suffices to contradict a claim, these use 0.05 divided by the number of parts. Where the
  runs themselves pick the highest of several cells, 0.05 is also divided by how many there are: to
  support, of those that should lead; to contradict, of their rivals.
- that a mean is higher in most cells: by the cells that surely lead, and those that surely trail,
  each by Welch's interval at a level divided by their number.
- a mean against a task's maximum: as no run can be above it, one run below it shows that the mean
  is below it too. That it reaches the maximum, or that there is no significant difference (by the
  two-sided test), no fewer seeds than the paper's 30 bear out.
- undecided otherwise, and where a cell is not in the budget, lacks seeds (or one does that it was
  chosen among), or has fewer than 5. Fewer generations than the paper's 500 decide nothing that
  more could overturn: that a level, or a lead of so many points, is not reached, or that larger
  populations do not pay at equal cost; other comparisons they do, at this budget. But tasks of
  different numbers of generations are not compared with each other.

Claims overlap: several rest on the same runs and comparisons, so their numbers are no count of
independent findings.
"""

import json
import math
import zlib
from collections import Counter
from dataclasses import dataclass
from pathlib import Path
from typing import Annotated, Literal

import numpy as np
from pydantic import Field, ValidationError

from neol.base.errors import UserError
from neol.spec.configuration import ROOT
from neol.spec.plain_yaml import read_yaml
from neol.spec.types import Model
from neol.study.claims.comparisons import Compare, Gain, Part, Rank, Significant
from neol.study.claims.grids import Level, Peak, Sensitivity, Share, Trend
from neol.study.outcomes.outcomes import EQUAL, Outcomes
from neol.study.outcomes.score import PAPER_GENERATIONS
from neol.study.outcomes.statistics import ALPHA

CLAIMS = ROOT / "paper" / "claims.yaml"
LEAST_SEEDS = 5
TOO_FEW = f"fewer than {LEAST_SEEDS} seeds"
SEEDS_MISSING = "seeds are missing"
NO_SUCH_CELL = "no such cell here"
TOO_SHORT = f"fewer than {PAPER_GENERATIONS} generations"
NO_COMMON_RANGE = "no cost that all runs have in common"
UNEQUAL_TASKS = "tasks of different numbers of generations"

Test = Annotated[
    Compare | Significant | Rank | Gain | Level | Share | Trend | Peak | Sensitivity,
    Field(discriminator="kind"),
]
Verdict = Literal["supported", "contradicted", "undecided"]


class Claim(Model):
    """What the paper says, where, and what decides it."""

    id: str
    place: str
    quote: str
    reading: str | None = None
    """How the words became a test, where that is not plain."""
    note: str | None = None
    """What the paper itself says against it."""
    tests: tuple[Test, ...]


class _Ledger(Model):
    lists: dict[str, tuple[str, ...]]
    """Anchors, for the file's own use."""
    claims: tuple[Claim, ...]


@dataclass(frozen=True, slots=True)
class PartVerdict:
    """What the runs say about a part."""

    part: Part
    verdict: Verdict
    reason: str = ""
    """Why undecided, where not for the interval."""
    effect: float = math.nan
    low: float = math.nan
    high: float = math.nan
    """The 95% interval."""
    p: float = math.nan
    """Of the rank-sum test: one-sided; two-sided for a claim of no significance."""
    seeds: int = 0
    """Of the cell that has the fewest."""
    needed: float = math.nan
    """Seeds with which an effect of this size decides the part 4 times of 5; NaN where unknown."""


@dataclass(frozen=True, slots=True)
class Decision:
    """A claim and what its parts came to."""

    claim: Claim
    findings: tuple[PartVerdict, ...]

    @property
    def verdict(self) -> Verdict:
        """All parts must be supported; one contradicts."""
        verdicts = {finding.verdict for finding in self.findings}
        if "contradicted" in verdicts:
            return "contradicted"
        return "undecided" if "undecided" in verdicts else "supported"

    @property
    def decisive(self) -> PartVerdict:
        """The finding that the verdict hangs on: the lowest of those that gave it."""
        same = [finding for finding in self.findings if finding.verdict == self.verdict]
        return min(same, key=lambda finding: (math.isnan(finding.low), finding.low))

    @property
    def supported(self) -> int:
        """How many parts are."""
        return sum(finding.verdict == "supported" for finding in self.findings)


def load_claims(path: Path = CLAIMS) -> tuple[Claim, ...]:
    """The claims of a ledger. Raises UserError in one line for what is wrong in it."""
    try:
        content = read_yaml(path, path.name)
        claims = _Ledger.model_validate_json(json.dumps(content)).claims
    except ValidationError as error:
        raise UserError(f"{path.name}: {_first(error)}") from None
    twice = [name for name, count in Counter(claim.id for claim in claims).items() if count > 1]
    if twice:
        raise UserError(f'{path.name}: two claims are called "{twice[0]}"')
    return claims


def decide(claim: Claim, outcomes: Outcomes, *, seed: int = 0) -> Decision:
    """Decide a claim; `seed` is the bootstrap's. The same part of another claim comes out alike."""
    parts = [part for test in claim.tests for part in test.parts(outcomes)]
    alpha = ALPHA / len(parts)
    findings = []
    for part in parts:
        name = f"{part.label}, {part.unit}".encode()
        random = np.random.default_rng([seed, zlib.crc32(name)])
        findings.append(_find(part, outcomes, random, alpha))
    return Decision(claim, tuple(findings))


def _find(part: Part, outcomes: Outcomes, random: np.random.Generator, alpha: float) -> PartVerdict:
    cells = [cell for cell in part.cells if cell is not None]
    missing = any(outcomes.missing(cell) for cell in (*cells, *part.among))
    if len(cells) < len(part.cells):
        return PartVerdict(part, "undecided", SEEDS_MISSING if missing else NO_SUCH_CELL)
    samples = outcomes.samples(cells, part.metric)
    seeds = min(map(len, samples))
    if any(np.isnan(sample).any() for sample in samples):
        reason = NO_COMMON_RANGE if part.metric in EQUAL else "a run has no value"
        return PartVerdict(part, "undecided", reason, seeds=seeds)
    if seeds < 2:
        return PartVerdict(part, "undecided", f"{seeds} seeds", seeds=seeds)
    judged = part.rule(samples, random, alpha)
    verdict: Verdict = (
        "supported" if judged.right else "contradicted" if judged.wrong else "undecided"
    )
    generations = {outcomes.budget.generations_of(cell.task) for cell in cells}
    reason = ""
    if missing:
        reason = SEEDS_MISSING
    elif seeds < LEAST_SEEDS:
        reason = TOO_FEW
    elif len(generations) > 1:
        reason = UNEQUAL_TASKS
    elif verdict == part.provisional and min(generations) < PAPER_GENERATIONS:
        reason = TOO_SHORT
    return PartVerdict(
        part,
        "undecided" if reason else verdict,
        reason,
        judged.effect,
        judged.low,
        judged.high,
        judged.p,
        seeds,
        float(np.maximum(judged.needed, LEAST_SEEDS)),
    )


def _first(error: ValidationError) -> str:
    """Place and cause of the first error; a union of tests has no one set of keys to name."""
    first = error.errors()[0]
    place = ".".join(map(str, first["loc"]))
    return f"{place}: {first['msg']}"
