"""Pages of docs/ on speed, made from docs/benchmarks.csv.

`python -m benchmarks.report` makes page, plot and the numbers of scaling.md again from that file.
"""

import importlib.metadata
import platform
from collections.abc import Mapping
from pathlib import Path

import pandas as pd

from benchmarks import envpool_steps
from benchmarks.page import page
from benchmarks.plot import plot
from benchmarks.scaling import BEGIN, END, scaling
from benchmarks.table import Table
from neol.base.files import replace_between, write_atomically
from neol.run.provenance import provenance

DOCS = Path(__file__).resolve().parent.parent / "docs"


def machine() -> dict[str, str]:
    """Describe the machine and versions of the measurements."""
    made = provenance()
    versions = {**made.versions, "neat-python": importlib.metadata.version("neat-python")}
    if envpool_steps.AVAILABLE:
        versions["envpool"] = importlib.metadata.version("envpool")
    return {
        "CPU": made.cpu,
        "System": f"{platform.system()} on {platform.machine()}, {made.libc}",
        "Versions": ", ".join(f"{name} {version}" for name, version in versions.items()),
        "Commit": f"{made.commit}{' with changes' if made.dirty else ''}",
        "Date": made.time.partition("T")[0],
    }


def write(folder: Path, table: pd.DataFrame, about: Mapping[str, str]) -> None:
    """Write benchmarks.csv, which begins with its machine and versions, and the pages from it."""
    lines = [f"# {name}: {text}\n" for name, text in about.items()]
    content = "".join(lines) + table.to_csv(index=False, float_format="%.6g")
    write_atomically(folder / "benchmarks.csv", content.encode())
    render(folder)


def render(folder: Path) -> None:
    """Make the page, the plot and, if it exists, the numbers of scaling.md from benchmarks.csv."""
    path = folder / "benchmarks.csv"
    lines = path.read_text(encoding="utf-8").splitlines()
    about = dict(line[2:].split(": ", 1) for line in lines if line.startswith("# "))
    table = Table(pd.read_csv(path, comment="#", keep_default_na=False))
    write_atomically(folder / "benchmarks.md", page(table, about).encode())
    plot(table, folder / "benchmarks.png")
    text = folder / "scaling.md"
    if text.exists():
        old = text.read_text(encoding="utf-8")
        generated = f"\n{scaling(table, about)}\n"
        write_atomically(text, replace_between(old, BEGIN, END, generated).encode())


if __name__ == "__main__":
    render(DOCS)
