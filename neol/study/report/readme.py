"""The parts of README.md that repeat docs/results.md, between markers.

`python -m neol.study.report.readme` writes them again after the results page.
"""

import re
import textwrap

from neol.base.files import replace_between, write_atomically
from neol.spec.configuration import ROOT

README, RESULTS_PAGE = ROOT / "README.md", ROOT / "docs" / "results.md"
PARTS = ("answer", "Table 1", "in short")
WIDTH = 120


def parts(results: str) -> dict[str, str]:
    """Return the parts of the results page that README shows, by name.

    Sentences are wrapped as in README; tables and lists are as on the page.
    """
    in_short = results.split("\n## In short\n\n")[1].split("\nThe tables below")[0]
    *answer, points = in_short.strip().split("\n\n")
    table_1 = re.search(r"\n## Table 1\n[\s\S]*?\n((?:\|.*\n)+)", results)
    assert table_1, f"{RESULTS_PAGE} has no Table 1"
    wrapped = [block if block.startswith("|") else _wrap(block) for block in answer]
    return dict(zip(PARTS, ("\n\n".join(wrapped), table_1[1].strip(), points), strict=True))


def with_parts(readme: str, results: str) -> str:
    """Return README with its parts as the results page has them."""
    for name, part in parts(results).items():
        begin, end = (f"<!-- {name} of docs/results.md: {edge} -->" for edge in ("begin", "end"))
        readme = replace_between(readme, begin, end, f"\n\n{part}\n\n")
    return readme


def _wrap(sentences: str) -> str:
    return textwrap.fill(sentences, WIDTH, break_long_words=False, break_on_hyphens=False)


if __name__ == "__main__":
    shown = with_parts(README.read_text(encoding="utf-8"), RESULTS_PAGE.read_text(encoding="utf-8"))
    write_atomically(README, shown.encode())
