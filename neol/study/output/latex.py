"""Plain text as LaTeX."""

import re

_SPECIAL = {
    "\\": "\\textbackslash{}",
    "&": "\\&",
    "%": "\\%",
    "#": "\\#",
    "[": "{[}",  # after a line's \\\\ it would begin an argument
    "_": "\\_",
    "$": "\\$",
    "{": "\\{",
    "}": "\\}",
    "~": "\\textasciitilde{}",
    "^": "\\textasciicircum{}",
    "±": "$\\pm$",
    "≈": "$\\approx$",
    "≤": "$\\leq$",
    "≥": "$\\geq$",
    "×": "$\\times$",
    "<": "$<$",
    ">": "$>$",
}


def escape(text: str) -> str:
    """The text for LaTeX; a hyphen that is a minus becomes one, dashes and hyphens stay."""
    escaped = "".join(_SPECIAL.get(character, character) for character in text)
    return re.sub(r"(?<![\w-])-(?=\d)|(?<= )-(?= )|(?<=\de)-(?=\d)", "$-$", escaped)
