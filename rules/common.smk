"""What all rules share: the budget, its runs, and what each notebook makes."""

import re
import sys
from glob import glob
from pathlib import Path

from neol.study.outcomes.chosen_cells import candidates
from neol.study.campaign.exhibits import BEYOND, heatmaps_of
from neol.study.campaign.grid import blocks
from neol.study.campaign.cost import walltime_minutes
from neol.base.errors import UserError
from neol.study.campaign.jobs import jobs
from neol.run.workspace import remove_if_complete
from neol.study.campaign.shown import (
    DEFAULT_BUDGET,
    SHOWN_READING,
    figures_folder,
    full_label,
    label,
    select,
)
from neol.spec.configuration import budgets
from neol.spec.readings import with_changes
from neol.study.campaign.snakemake import clear_stale_locks, pattern

TABLE, FIGURE = ("tex", "csv", "json"), ("pdf", "png", "json")
CATEGORIES = {
    "table": "Tables",
    "figure": "Figures",
    "claims": "Claims",
    "beyond": "Beyond the paper",
}
ANALYSIS, DRAWING = ("outcomes", "claims", "output", "tables"), (
    "study/figures",
    "pictures",
)

# The Python of this environment, also where it is not activated: so `conda:` below only documents the software, as
# `snakemake --lint` asks of each rule.
shell.prefix(
    f"set -euo pipefail; export PATH='{Path(sys.executable).parent}':\"$PATH\"; "
)

ALLOWED = "budget", "reading", "set", "tasks"
if unknown := sorted(set(config) - set(ALLOWED)):
    sys.exit(
        f"neol: --config {unknown[0]}: unknown key (allowed: {', '.join(ALLOWED)})"
    )
BUDGET, TASKS = str(config.get("budget", DEFAULT_BUDGET)), str(
    config.get("tasks") or ""
)
try:
    CONFIGURATION = select(
        BUDGET,
        TASKS,
        with_changes(str(config.get("reading", SHOWN_READING)), config.get("set")),
    )
except UserError as error:
    sys.exit(f"neol: {error}")
READING = CONFIGURATION.reading
LABEL, FIGURES = label(CONFIGURATION), str(figures_folder(CONFIGURATION))
# Where executed notebooks and what the workflow says lie.
PLACE = full_label(CONFIGURATION)
if FIGURES == "figures":
    RESULTS_PAGE = "docs/results.md"
    ELSEWHERE = r"docs/results-.+\.md|figures/.+/.+"
else:
    RESULTS_PAGE = f"docs/results-{LABEL.replace('/', '-')}.md"
    ELSEWHERE = rf"docs/results(?!-{re.escape(LABEL.replace('/', '-'))}\.).*\.md|paper/reproduction\.pdf|figures/(?!{re.escape(LABEL)}/).+"
ALIVE = clear_stale_locks()
BLOCKS = {str(block.record): block for block in blocks(CONFIGURATION)}
JOBS = {str(job.record): job for job in jobs(CONFIGURATION)}


def tidy():
    """Remove the .partial folders of the records that are there.

    Not sooner than when all is over: Snakemake removes the record of a job that something kills after its last write.
    So what a killed workflow left goes at the end of the next one, and no dry run takes it away.
    """
    for path in JOBS:
        remove_if_complete(Path(path))


REASONS = {path: job.reason() for path, job in JOBS.items()}
KEPT = pattern(job.record for path, job in JOBS.items() if not REASONS[path])


def job(wildcards):
    """The job that makes a record."""
    path = f"results/{wildcards.record}.parquet"
    if path not in JOBS:
        sys.exit(
            f"neol: {path}: {LABEL} has no such record, {next(iter(JOBS))} is its first"
        )
    return JOBS[path]


def run_minutes(wildcards):
    """How long a cluster shall let a job run."""
    this = job(wildcards)
    return walltime_minutes(this.spec, len(this.seeds))


def shown(*settings):
    """The records that tables of some settings choose among; of all cells without any."""
    cells = {
        cell
        for setting in settings
        for among in candidates(CONFIGURATION, setting).values()
        for cell in among
    }
    return [
        path for path, block in BLOCKS.items() if block.cell in cells or not settings
    ]


def outputs(kinds, *names):
    """The files of some tables or figures."""
    return expand(f"{FIGURES}/{{name}}.{{kind}}", name=names, kind=kinds)


def with_imports(*files):
    """Some files of code and those that they import: which cells there are, what a record holds.

    Not what these stand on, which is all that makes a run.
    """
    text = "\n".join(Path(file).read_text(encoding="utf-8") for file in files)
    modules = re.findall(r"^from (neol[\w.]+) import", text, re.MULTILINE)
    paths = (Path(module.replace(".", "/")) for module in modules)
    imported = (
        path / "__init__.py" if path.is_dir() else f"{path}.py" for path in paths
    )
    return sorted({*files, *map(str, imported)})


def code(*, draws):
    """What a notebook's outputs depend on: a change of drawing makes no table anew."""
    folders = [f"study/{folder}" for folder in ANALYSIS] + [*DRAWING] * draws
    return with_imports(
        *(file for folder in folders for file in glob(f"neol/{folder}/*.py"))
    )


def ask_otherwise(wildcards):
    """Refuse what another budget or reading shows, and say what to ask for."""
    path = Path(wildcards.elsewhere)
    page = path.parent == Path("docs")
    place = path.with_suffix("") if page else path.parent
    reading, budget = "(?:([^/]+)/)?", f"({'|'.join(budgets())})(?:-(.+))?"
    other = re.fullmatch(f"(?:figures/|docs/results-)({reading}{budget})", str(place))
    if other and other[1] not in (LABEL, DEFAULT_BUDGET):
        chosen = zip(("reading", "budget", "tasks"), other.groups()[1:], strict=True)
        options = " ".join(f"{name}={value}" for name, value in chosen if value)
        sys.exit(f"neol: {path} needs --config {options}")
    wanted = RESULTS_PAGE if page else f"{FIGURES}/{path.name}"
    sys.exit(f"neol: {path} does not show {LABEL}: ask for {wanted}")


heatmaps = [f"figure{number}" for number in heatmaps_of(CONFIGURATION.budget)]
# Each notebook: what it makes, the records that it reads, the code that it stands on.
NOTEBOOKS = {
    "tables": (
        outputs(TABLE, "table1", "table3", "table5"),
        shown("table3"),
        code(draws=False),
    ),
    "efficiency": (
        outputs(TABLE, "table2", "table6"),
        shown("score"),
        code(draws=False),
    ),
    "ablation": (
        outputs(TABLE, "table4", "table7", "table8"),
        shown("table4", "score"),
        code(draws=False),
    ),
    "convergence": (
        outputs(FIGURE, "figure2", "figure3"),
        shown("table3", "table4"),
        code(draws=True),
    ),
    "heatmaps": (outputs(FIGURE, *heatmaps), shown(), code(draws=True)),
    "claims": (
        outputs((*TABLE, "md"), "claims"),
        shown(),
        [*code(draws=False), "paper/claims.yaml"],
    ),
    "beyond": (
        outputs((*FIGURE, "csv"), *BEYOND),
        list(JOBS),
        [*code(draws=True), *sorted(glob("config/sensitivity/*.yaml"))],
    ),
}


def made_by(*notebooks):
    """What some notebooks make."""
    return [path for notebook in notebooks for path in NOTEBOOKS[notebook][0]]


def captioned(path):
    """A picture or table as `snakemake --report` shows it, with its caption; other files as they are."""
    name = Path(path).stem
    if not path.endswith((".png", ".csv")):
        return path
    kind = next(kind for kind in CATEGORIES if name.startswith(kind))
    caption = f"paper/captions/{name}.rst"
    return report(path, caption=caption, category=CATEGORIES[kind])
