"""From a budget's runs to the paper's tables: `snakemake figures/table1.tex`.

`snakemake tables --config budget=desk` spends another budget and writes to figures/desk/. A run is made where its
record is missing or its specification has changed, whatever the times of files.
"""

import sys
from glob import glob
from pathlib import Path

from neol.analysis.choice import candidates
from neol.campaign import blocks, run_specs
from neol.errors import UserError
from neol.spec import budgets, load_configuration

DEFAULT_BUDGET = "smoke"
BUDGET = str(config.get("budget", DEFAULT_BUDGET))
FIGURES = "figures" if BUDGET == DEFAULT_BUDGET else f"figures/{BUDGET}"
TABLES = expand("{folder}/{table}", folder=FIGURES, table=["table1", "table3"])

# The Python of this environment, also where it is not activated.
shell.prefix(
    f"set -euo pipefail; export PATH='{Path(sys.executable).parent}':\"$PATH\"; "
)

if set(config) - {"budget"}:
    sys.exit(
        f"neol: --config {min(set(config) - {'budget'})}: unknown key (allowed: budget)"
    )
try:
    CONFIGURATION = load_configuration(BUDGET)
except UserError as error:
    sys.exit(f"neol: {error}")
BLOCKS = {str(block.record): block for block in blocks(CONFIGURATION)}


def block(wildcards):
    """The block whose record is asked for."""
    path = f"results/{wildcards.record}.parquet"
    if path not in BLOCKS:
        sys.exit(
            f"neol: {path}: budget {BUDGET} has no such record, {next(iter(BLOCKS))} is its first"
        )
    return BLOCKS[path]


def run_arguments(wildcards):
    """A block as the command line of `neol run` has it."""
    this = block(wildcards)
    cell = this.cell
    rate = "" if cell.learning_rate is None else f"--learning-rate {cell.learning_rate}"
    return (
        f"--budget {this.budget} --task {cell.task} --method {cell.method} --population {cell.population} {rate} "
        f"--generations {CONFIGURATION.budget.generations} --seed {this.first}-{this.last}"
    )


def run_specification(wildcards):
    """What a block's record must agree with: when it changes, its runs and no others are planned."""
    return run_specs(CONFIGURATION, block(wildcards))[0].digest()


def table_records(wildcards):
    """The records that the tables are made from."""
    shown = {cell for cells in candidates(CONFIGURATION).values() for cell in cells}
    return [path for path, block in BLOCKS.items() if block.cell in shown]


def ask_otherwise(wildcards):
    """Refuse what another budget shows, and say what to ask for."""
    folder, _, name = wildcards.path.rpartition("/")
    if folder in set(budgets()) - {BUDGET, DEFAULT_BUDGET}:
        sys.exit(
            f"neol: figures/{wildcards.path} shows budget {folder}: add --config budget={folder}"
        )
    sys.exit(
        f"neol: figures/{wildcards.path} is no figure of budget {BUDGET}: ask for {FIGURES}/{name}"
    )


localrules:
    all,
    tables,
    records,
    elsewhere,


wildcard_constraints:
    record=f"{BUDGET}/.+",
    path=".+/.+" if BUDGET == DEFAULT_BUDGET else f"(?!{BUDGET}/).+",


rule all:
    input:
        list(BLOCKS),
        expand("{table}.tex", table=TABLES),


rule tables:
    input:
        expand("{table}.tex", table=TABLES),


rule records:
    input:
        list(BLOCKS),


rule run:
    output:
        "results/{record}.parquet",
    log:
        "logs/{record}.log",
    benchmark:
        "logs/{record}.tsv"
    conda:
        "environment.yml"
    threads: 1
    resources:
        mem_mb=500,
    params:
        arguments=run_arguments,
        specification=run_specification,
    shell:
        "python -m neol run {params.arguments} --workers {threads} --resume --quiet --output {output} > {log} 2>&1"


rule paper_tables:
    input:
        notebook="notebooks/tables.ipynb",
        code=sorted(glob("neol/analysis/*.py")),
        reference=sorted(glob("paper/reference/*.csv")),
        records=table_records,
    output:
        expand("{table}.{suffix}", table=TABLES, suffix=["tex", "csv", "json"]),
        notebook=f"build/{BUDGET}/tables.ipynb",
    log:
        f"logs/{BUDGET}/tables.log",
    benchmark:
        f"logs/{BUDGET}/tables.tsv"
    conda:
        "environment.yml"
    threads: 1
    resources:
        mem_mb=1000,
    params:
        budget=BUDGET,
        output=f"../{FIGURES}",
    shell:
        "python -m papermill --cwd notebooks -p budget {params.budget} -p results ../results -p output {params.output} "
        "{input.notebook} {output.notebook} > {log} 2>&1"


rule elsewhere:
    input:
        ask_otherwise,
    output:
        "figures/{path}",
