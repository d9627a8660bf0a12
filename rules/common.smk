"""What all rules share: the budget, its runs, and what each notebook makes."""

import os
import shlex
import sys
from glob import glob
from pathlib import Path

from neol.base.errors import UserError
from neol.run.provenance import ASKING_PACKAGE, this_package
from neol.run.record_file import records_below
from neol.run.workspace import remove_if_complete
from neol.spec.readings import with_changes
from neol.study.campaign.cost import walltime_minutes
from neol.study.campaign.grid import RESULTS
from neol.study.campaign.jobs import SENSITIVITY, jobs
from neol.study.campaign.search import CONFIRMATION, SCREENING
from neol.study.campaign.shown import (
    DEFAULT_BUDGET,
    SHOWN_READING,
    figures_folder,
    full_label,
    results_page,
    select,
)
from neol.study.workflow.exhibits import by_notebook, exhibits, records
from neol.study.workflow.snakemake import clear_stale_locks, pattern

# The Python of this environment, also where it is not activated: so `conda:` below only documents the software, as
# `snakemake --lint` asks of each rule. Jupyter finds this environment's kernel before any other of its name, such as a
# user's own, and a notebook refuses to run another neol than this one.
BIN, KERNELS, PACKAGE = (
    shlex.quote(str(path))
    for path in (
        Path(sys.executable).parent,
        Path(sys.prefix, "share", "jupyter"),
        this_package(),
    )
)
shell.prefix(
    f'set -euo pipefail; export PATH={BIN}:"$PATH" JUPYTER_PATH={KERNELS} {ASKING_PACKAGE}={PACKAGE}; '
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
FIGURES, RESULTS_PAGE = (
    str(where(CONFIGURATION)) for where in (figures_folder, results_page)
)
# Where executed notebooks and what the workflow says lie.
PLACE = full_label(CONFIGURATION)
ALIVE = clear_stale_locks()
JOBS = {str(job.record): job for job in jobs(CONFIGURATION)}
GRID_RECORDS = [path for path, job in JOBS.items() if job.part != SENSITIVITY]


def tidy():
    """Remove the .partial folders of the records that are there.

    Not sooner than when all is over: Snakemake removes the record of a job that something kills after its last write.
    So what a killed workflow left goes at the end of the next one, and no dry run takes it away.
    """
    for path in JOBS:
        remove_if_complete(Path(path))


REASONS = {path: job.reason() for path, job in JOBS.items()}
NEEDED = pattern(job.record for path, job in JOBS.items() if REASONS[path])
# Records that are as they should be are nobody's output, so `--delete-all-output` leaves them alone. Only where one is
# itself a target of the command, Snakemake needs a rule for it.
KEPT = pattern(
    job.record
    for path, job in JOBS.items()
    if not REASONS[path] and path in map(os.path.normpath, sys.argv)
)


def job(wildcards):
    """The job that makes a record."""
    return JOBS[f"results/{wildcards.record}.parquet"]


def run_minutes(wildcards):
    """How long a cluster shall let a job run."""
    this = job(wildcards)
    return walltime_minutes(this.spec, len(this.seeds))


def papermill_arguments():
    """The parameters of every notebook, as words of a shell."""
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
    """The files of code in some folders of neol/."""
    return sorted(path for folder in folders for path in glob(f"neol/{folder}/*.py"))


# What results stand on: which runs there are, how a record is read, what each run came to. Not what makes a run: where
# a change there matters, records change. Figures also stand on what draws, so a change of drawing makes no table anew.
RESULT_CODE = python("spec", "study/campaign", "study/outcomes") + [
    "neol/run/record.py",
    "neol/run/record_file.py",
    "neol/pictures/labels.py",
]
TABLE_CODE = RESULT_CODE + python("study/output", "study/tables", "study/claims")
FIGURE_CODE = sorted({*TABLE_CODE, *python("pictures", "study/figures")})


def files(exhibit):
    """The files of a table or figure."""
    return [f"{FIGURES}/{exhibit.name}.{suffix}" for suffix in exhibit.group.suffixes]


def made(*targets):
    """The files of some targets, or of all tables and figures."""
    return [
        path
        for each in exhibits(CONFIGURATION.budget, *targets)
        for path in files(each)
    ]


def inputs(together):
    """What tables and figures of one notebook depend on, beside the notebook."""
    drawn = any("png" in each.group.suffixes for each in together)
    also = [path for each in together for path in glob(each.files or "")]
    read = {path for each in together for path in records(CONFIGURATION, each.reads)}
    return {
        "code": FIGURE_CODE if drawn else TABLE_CODE,
        "paper": sorted(glob("paper/reference/*.csv")),
        "also": sorted(also),
        "records": sorted(str(RESULTS / path) for path in read),
    }


def captioned(path, exhibit):
    """A picture or a table's numbers as `snakemake --report` shows them; another file as it is."""
    if not path.endswith((".png", ".csv")):
        return path
    labels = {"caption": exhibit.caption}
    return report(path, category=exhibit.group.title, labels=labels)
