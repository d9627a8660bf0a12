# The report of the reproduction: `snakemake paper/reproduction.pdf`. Nothing else needs LaTeX.

# The paper of another budget than the default one lies in its folder of figures.
PAPER = (
    "paper/reproduction.pdf"
    if BUDGET == DEFAULT_BUDGET
    else f"{FIGURES}/reproduction.pdf"
)
PICTURES = [path for path in made_by("convergence", "beyond") if path.endswith(".pdf")]
TABLES = [
    path
    for path in made_by("tables", "efficiency", "ablation", "claims", "beyond")
    if path.endswith((".tex", ".csv"))
]


rule paper_numbers:
    input:
        tables=TABLES,
        code=["neol/report/numbers.py", "neol/report/costs.py", "pyproject.toml"],
    output:
        f"build/{BUDGET}/paper/results.tex",
    log:
        f"logs/{BUDGET}/paper_numbers.log",
    benchmark:
        f"logs/{BUDGET}/paper_numbers.tsv"
    conda:
        "../environment.yml"
    threads: 1
    resources:
        mem_mb=1000,
    params:
        budget=BUDGET,
        figures=lambda wildcards, input: Path(input.tables[0]).parent,
    shell:
        "python -m neol.report.numbers {params.budget} {params.figures} {output} > {log} 2>&1"


rule paper:
    input:
        text="paper/reproduction.tex",
        numbers=rules.paper_numbers.output,
        tables=TABLES,
        pictures=PICTURES,
    output:
        PAPER,
    log:
        f"logs/{BUDGET}/paper.log",
    benchmark:
        f"logs/{BUDGET}/paper.tsv"
    conda:
        "../environment.yml"
    threads: 1
    resources:
        mem_mb=500,
    shell:
        "paper/build.sh {input.text} {input.numbers} {output} > {log}"
