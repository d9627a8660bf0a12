"""Conversion of plain text to LaTeX."""

import re

_SPECIAL = {
    "\\": "\\textbackslash{}",
    "&": "\\&",
    "%": "\\%",
    "#": "\\#",
    "[": "{[}",  # after \\\\ at the end of a line it would begin an argument
    "_": "\\_",
    "$": "\\$",
    "{": "\\{",
    "}": "\\}",
    "~": "\\textasciitilde{}",
    "^": "\\textasciicircum{}",
    "†": "\\textdagger{}",
    "±": "$\\pm$",
    "≈": "$\\approx$",
    "≤": "$\\leq$",
    "≥": "$\\geq$",
    "×": "$\\times$",
    "<": "$<$",
    ">": "$>$",
}


def escape(text: str) -> str:
    """Escape text for LaTeX; hyphens that mean minus become minus signs, all others stay.

    Line breaks become spaces, because a blank line would end a paragraph or a macro's argument.
    """
    escaped = "".join(_SPECIAL.get(character, character) for character in " ".join(text.split()))
    return re.sub(r"(?<![\w-])-(?=\d)|(?<= )-(?= )|(?<=\de)-(?=\d)", "$-$", escaped)
