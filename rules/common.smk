"""Definitions for all rules: the budget, its runs, and the outputs of each notebook."""

import os
import shlex
import sys
from glob import glob
from pathlib import Path

from neol.base.errors import UserError
from neol.run.provenance import ASKING_PACKAGE, this_package
from neol.run.record_file import records_below
from neol.run.workspace import remove_if_complete
from neol.spec.configuration import PAPER_BUDGET
from neol.spec.readings import DEFAULT_READING, with_changes
from neol.study.campaign.cost import walltime_minutes
from neol.study.campaign.grid import RESULTS
from neol.study.campaign.jobs import SENSITIVITY, jobs
from neol.study.campaign.multiverse import BUDGET as MULTIVERSE
from neol.study.campaign.search import CONFIRMATION, SCREENING
from neol.study.campaign.shown import (
    DEFAULT_BUDGET,
    figures_folder,
    full_label,
    results_page,
    select,
)
from neol.study.workflow.exhibits import by_notebook, exhibits, records
from neol.study.workflow.snakemake import (
    clear_stale_locks,
    pattern,
    refuse_braces,
    refuse_unknown_exhibits,
)

try:
    refuse_braces(Path.cwd(), Path(sys.prefix), this_package())
except UserError as error:
    sys.exit(f"neol: {error}")

# The Python of this environment, also if it is not activated: `conda:` below only documents the software, because
# `snakemake --lint` requires it. Jupyter finds this environment's kernel before any other of its name, such as a
# user's own, and a notebook refuses to run another neol than this one. Pictures are written to files, so a backend of
# Matplotlib's that is chosen for windows, or is none, must not matter.
BIN, KERNELS, PACKAGE = (
    shlex.quote(str(path))
    for path in (
        Path(sys.executable).parent,
        Path(sys.prefix, "share", "jupyter"),
        this_package(),
    )
)
shell.prefix(
    f'set -euo pipefail; unset MPLBACKEND; export PATH={BIN}:"$PATH" JUPYTER_PATH={KERNELS} {ASKING_PACKAGE}={PACKAGE}; '
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
        with_changes(str(config.get("reading", DEFAULT_READING)), config.get("set")),
    )
    refuse_unknown_exhibits(sys.argv[1:], CONFIGURATION)
    ALIVE = clear_stale_locks()
except UserError as error:
    sys.exit(f"neol: {error}")
READING = CONFIGURATION.reading
FIGURES, RESULTS_PAGE = (
    str(where(CONFIGURATION)) for where in (figures_folder, results_page)
)
# Folder of executed notebooks and of logs.
PLACE = full_label(CONFIGURATION)
JOBS = {str(job.record): job for job in jobs(CONFIGURATION)}
GRID_RECORDS = [path for path, job in JOBS.items() if job.part != SENSITIVITY]


def tidy():
    """Remove the .partial folders of existing records.

    This happens at the end only, because Snakemake removes the record of a job that is killed after its last write. So
    the end of the next workflow removes what a killed one left, and a dry run removes nothing.
    """
    for path in JOBS:
        remove_if_complete(Path(path))


REASONS = {path: job.reason() for path, job in JOBS.items()}


def remove_outdated():
    """Remove the .partial folders of existing records that will be made again.

    A killed workflow left them. Snakemake removes such a record before its job starts, which would then refuse the
    seeds of the former constants. Reasons are asked for again, because another workflow in this folder may have made
    the record meanwhile.
    """
    for path, job in JOBS.items():
        if REASONS[path] and job.reason():
            remove_if_complete(Path(path))


NEEDED = pattern(job.record for path, job in JOBS.items() if REASONS[path])
# Valid records are not outputs of any rule, so `--delete-all-output` keeps them. Snakemake needs a rule only for those
# that are targets of the command.
KEPT = pattern(
    job.record
    for path, job in JOBS.items()
    if not REASONS[path] and path in map(os.path.normpath, sys.argv)
)


def job(wildcards):
    """Return the job that makes a record."""
    return JOBS[f"results/{wildcards.record}.parquet"]


def run_minutes(wildcards):
    """Return the walltime to request for a job, in minutes."""
    this = job(wildcards)
    return walltime_minutes(this.spec, len(this.seeds))


def papermill_arguments():
    """Return the parameters of every notebook, quoted for a shell."""
    parameters = {
        "budget": BUDGET,
        "reading": READING,
        "tasks": TASKS,
        "results": "../results",
        "output": f"../{FIGURES}",
    }
    return shlex.join(
        word for name, value in parameters.items() for word in ("-p", name, value)
    )


def python(*folders):
    """Return the Python files in some folders of neol/."""
    return sorted(path for folder in folders for path in glob(f"neol/{folder}/*.py"))


# Code that results depend on: the grid of runs, reading of records, outcomes of runs. Code that makes runs is left out,
# because a change there that matters changes records. Only figures depend on code that draws.
RESULT_CODE = python("spec", "study/campaign", "study/outcomes") + [
    "neol/run/record.py",
    "neol/run/record_file.py",
    "neol/pictures/labels.py",
]
TABLE_CODE = RESULT_CODE + python("study/output", "study/tables", "study/claims")
FIGURE_CODE = sorted({*TABLE_CODE, *python("pictures", "study/figures")})


def paper_records(reading):
    """Return the records at the paper's budget of a reading and of its variants, such as other betas."""
    return sorted(glob(f"results/{reading}*/{PAPER_BUDGET}/*/*/*/*.parquet"))


def files(exhibit):
    """Return the files of a table or figure."""
    return [f"{FIGURES}/{exhibit.name}.{suffix}" for suffix in exhibit.group.suffixes]


def made(*targets):
    """Return the files of some targets, or of all tables and figures."""
    return [
        path
        for each in exhibits(CONFIGURATION.budget, *targets)
        for path in files(each)
    ]


def inputs(together):
    """Return the inputs of one notebook's tables and figures, without the notebook."""
    drawn = any("png" in each.group.suffixes for each in together)
    also = [path for each in together for name in each.files for path in glob(name)]
    read = {path for each in together for path in records(CONFIGURATION, each.reads)}
    return {
        "code": FIGURE_CODE if drawn else TABLE_CODE,
        "paper": sorted(glob("paper/reference/*.csv")),
        "also": sorted(also),
        "built": sorted(
            f"build/{PLACE}/{name}" for each in together for name in each.built
        ),
        "records": sorted(str(RESULTS / path) for path in read),
    }


def captioned(path, exhibit):
    """Return pictures and tables of numbers marked for `snakemake --report`, other files unchanged."""
    if not path.endswith((".png", ".csv")):
        return path
    labels = {"caption": exhibit.caption}
    return report(path, category=exhibit.group.title, labels=labels)
