"""The workflow from runs to the paper's tables and figures: `snakemake figures/table1.tex`, `snakemake all`.

`snakemake tables --config budget=paper` uses another budget and writes to figures/paper/; `tasks=cartpole,hopper` after
that selects tasks and writes to figures/paper-cartpole,hopper/. A run is made if its record is missing or states another
specification; times of files do not matter.
"""


# All paths are from here, wherever `snakemake -s` is typed.
workdir: workflow.basedir


include: "rules/common.smk"
include: "rules/report.smk"


localrules:
    all,
    tables,
    numbers,
    figures,
    claims,
    beyond,
    records,
    report,
    kept,


onstart:
    remove_outdated()


onsuccess:
    tidy()


onerror:
    tidy()


rule all:
    input:
        GRID_RECORDS,
        made(),
        REPORT,


rule tables:
    input:
        made("tables"),


rule numbers:
    input:
        made("numbers"),


rule figures:
    input:
        made("figures"),


rule claims:
    input:
        made("claims"),


rule beyond:
    input:
        made("beyond"),


rule records:
    input:
        GRID_RECORDS,


# The profile forces this rule, which matches exactly the records that must be made.
rule run:
    output:
        "results/{record}.parquet",
    log:
        "logs/{record}.log",
    benchmark:
        "logs/{record}.tsv"
    wildcard_constraints:
        record=NEEDED,
    conda:
        "environment.yml"
    threads: 1
    resources:
        mem_mb=500,
        runtime=run_minutes,
    params:
        arguments=lambda wildcards: job(wildcards).arguments,
        reason=lambda wildcards: REASONS[f"results/{wildcards.record}.parquet"],
    message:
        "{params.reason}"
    shell:
        "python -m neol run {params.arguments} --workers {threads} --resume --keep-partial --quiet --output {output:q} > {log:q} 2>&1"


# A valid record that is named as a target needs nothing.
rule kept:
    output:
        "results/{record}.parquet",
    wildcard_constraints:
        record=KEPT,


# Each notebook makes the tables and figures that name it in neol/study/workflow/exhibits.py.
for notebook, together in by_notebook(exhibits(CONFIGURATION.budget)).items():

    rule:
        name:
            f"{notebook}_notebook"
        input:
            **inputs(together),
            notebook=f"notebooks/{notebook}.ipynb",
        output:
            [captioned(path, each) for each in together for path in files(each)],
            notebook=f"build/{PLACE}/{notebook}.ipynb",
            page=f"build/{PLACE}/{notebook}.html",
        log:
            f"logs/{PLACE}/{notebook}.log",
        benchmark:
            f"logs/{PLACE}/{notebook}.tsv"
        conda:
            "environment.yml"
        threads: 1
        resources:
            mem_mb=1000,
        params:
            arguments=papermill_arguments(),
        shell:
            "(python -m papermill --no-progress-bar --log-output --cwd notebooks {params.arguments} {input.notebook:q} {output.notebook:q} && "
            "python -m nbconvert --to html {output.notebook:q}) > {log:q} 2>&1; "
            "(grep '^neol: ' {log:q} || true) >&2"
