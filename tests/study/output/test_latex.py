"""Plain text as LaTeX."""

import pytest

from neol.study.claims.questions import load_claims
from neol.study.outcomes import paper_numbers
from neol.study.output.latex import escape

KNOWN = set("–—…“”‘’éèöüä")
"""What LaTeX itself reads beyond ASCII."""


@pytest.mark.parametrize(
    ("text", "latex"),
    [
        ("p_c & 5%", r"p\_c \& 5\%"),
        ("-3 to 4", "$-$3 to 4"),
        ("one-sided", "one-sided"),
        ("[BCM:] ≈ 0.74", r"{[}BCM:] $\approx$ 0.74"),
        ("1.2e-08", "1.2e$-$08"),
    ],
)
def test_escape(text: str, latex: str) -> None:
    assert escape(text) == latex


def test_all_that_is_quoted_can_be_set() -> None:
    """An unknown character would stop LaTeX."""
    texts = [text for notes in paper_numbers.CONTRADICTIONS.values() for text in notes]
    for claim in load_claims():
        texts += [claim.quote, claim.place]
    strange = {each for text in texts for each in escape(text) if not each.isascii()}
    assert strange <= KNOWN


def test_blank_lines_end_no_paragraph() -> None:
    assert escape("one\n\ntwo  three") == "one two three"
