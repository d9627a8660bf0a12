"""Reports on the results.

These are the page figures/report.html, the paper paper/reproduction.pdf (needs LaTeX), and the pages docs/results.md and
docs/readings.md, which are committed.
"""

REPORT = f"{FIGURES}/report.html"
PAPER = f"{'paper' if FIGURES == 'figures' else FIGURES}/reproduction.pdf"
CHAMPIONS = f"build/{PLACE}/champions.json"
PICTURES = [path for path in made() if path.endswith(".pdf")]
NUMBERS = [path for path in made() if path.endswith((".tex", ".csv"))]

# Inputs of sentences, captions and predictions of cost.
WORDS = sorted(glob("neol/study/report/*.*")) + [
    "neol/study/workflow/exhibits.py",
    "neol/study/campaign/cost.py",
    "docs/benchmarks.csv",
    "docs/episode-lengths.csv",
]


rule report:
    input:
        REPORT,


rule showcase:
    input:
        code=[
            "neol/study/report/showcase.py",
            *sorted({*RESULT_CODE, *python("champions", "pictures")}),
        ],
        records=[str(RESULTS / path) for path in records(CONFIGURATION, "table3")],
    output:
        CHAMPIONS,
    log:
        f"logs/{PLACE}/showcase.log",
    benchmark:
        f"logs/{PLACE}/showcase.tsv"
    conda:
        "../environment.yml"
    threads: 1
    resources:
        mem_mb=1000,
    params:
        budget=BUDGET,
        reading=READING,
        tasks=TASKS,
    shell:
        "python -m neol.study.report.showcase {params.budget:q} --reading {params.reading:q} --tasks={params.tasks:q} {output:q} > {log:q} 2>&1"


# A minute or two for each thousand champions, so it is kept apart from what is drawn of it.
rule switched_off:
    input:
        code=[
            "neol/study/report/switched_off.py",
            "neol/champions/player.py",
            *RESULT_CODE,
        ],
        records=[
            str(RESULTS / path)
            for path in dict.fromkeys(
                records(CONFIGURATION, "table3") + records(CONFIGURATION, "table4")
            )
        ],
    output:
        f"build/{PLACE}/switched_off.csv",
    log:
        f"logs/{PLACE}/switched_off.log",
    benchmark:
        f"logs/{PLACE}/switched_off.tsv"
    conda:
        "../environment.yml"
    threads: 1
    resources:
        mem_mb=1000,
    params:
        budget=BUDGET,
        reading=READING,
        tasks=TASKS,
    shell:
        "python -m neol.study.report.switched_off {params.budget:q} --reading {params.reading:q} --tasks={params.tasks:q} {output:q} > {log:q} 2>&1"


rule report_page:
    input:
        champions=CHAMPIONS,
        shown=made(),
        assumptions="docs/assumptions.md",
        citation="CITATION.cff",
        paper=paper_records(READING),
        code=WORDS,
    output:
        REPORT,
    log:
        f"logs/{PLACE}/report.log",
    benchmark:
        f"logs/{PLACE}/report.tsv"
    conda:
        "../environment.yml"
    threads: 1
    resources:
        mem_mb=1000,
    params:
        budget=BUDGET,
        reading=READING,
        tasks=TASKS,
        figures=lambda wildcards, output: Path(output[0]).parent,
    shell:
        "python -m neol.study.report.page {params.budget:q} --reading {params.reading:q} --tasks={params.tasks:q} {params.figures:q} {input.champions:q} {output:q} > {log:q} 2>&1"


rule results_page:
    input:
        shown=NUMBERS,
        picture=f"{FIGURES}/figure2.png",
        effects=f"{FIGURES}/beyond_effects.png",
        paper=paper_records(READING),
        code=WORDS,
    output:
        page=RESULTS_PAGE,
        picture=str(Path(RESULTS_PAGE).with_suffix(".png")),
        effects=RESULTS_PAGE.removesuffix(".md") + "-effects.png",
    log:
        f"logs/{PLACE}/results_page.log",
    benchmark:
        f"logs/{PLACE}/results_page.tsv"
    conda:
        "../environment.yml"
    threads: 1
    resources:
        mem_mb=1000,
    params:
        budget=BUDGET,
        reading=READING,
        tasks=TASKS,
        figures=lambda wildcards, input: Path(input.picture).parent,
    shell:
        "python -m neol.study.report.results {params.budget:q} --reading {params.reading:q} --tasks={params.tasks:q} {params.figures:q} {output.page:q} > {log:q} 2>&1"


# It uses the existing records; `make search` and `make multiverse` make those of docs/readings-plan.md. Once there are
# some of the multiverse, its pictures and numbers are written beside the page.
rule readings_page:
    input:
        records=[
            str(record)
            for budget in (SCREENING, CONFIRMATION, MULTIVERSE)
            for folder in sorted(Path("results").glob(f"*/{budget}"))
            for record in records_below(folder)
        ],
        paper=paper_records(DEFAULT_READING),
        candidates=glob("config/search/*.yaml") + sorted(glob("config/readings/*.yaml")),
        code=sorted(
            {
                *RESULT_CODE,
                *python("study/report", "pictures"),
                "neol/study/report/readings.md.j2",
            }
        ),
    output:
        page="docs/readings.md",
        picture="docs/readings.png",
    log:
        f"logs/{PLACE}/readings_page.log",
    benchmark:
        f"logs/{PLACE}/readings_page.tsv"
    conda:
        "../environment.yml"
    threads: 1
    resources:
        mem_mb=1000,
    shell:
        "python -m neol.study.report.readings {output.page:q} > {log:q} 2>&1"


rule paper_numbers:
    input:
        shown=NUMBERS,
        citation="CITATION.cff",
        paper=paper_records(READING),
        code=WORDS,
    output:
        f"build/{PLACE}/paper/results.tex",
    log:
        f"logs/{PLACE}/paper_numbers.log",
    benchmark:
        f"logs/{PLACE}/paper_numbers.tsv"
    conda:
        "../environment.yml"
    threads: 1
    resources:
        mem_mb=1000,
    params:
        budget=BUDGET,
        reading=READING,
        tasks=TASKS,
        figures=lambda wildcards, input: Path(input.shown[0]).parent,
    shell:
        "python -m neol.study.report.paper_text {params.budget:q} --reading {params.reading:q} --tasks={params.tasks:q} {params.figures:q} {output:q} > {log:q} 2>&1"


rule paper:
    input:
        text="paper/reproduction.tex",
        numbers=rules.paper_numbers.output,
        shown=NUMBERS + PICTURES,
        script="paper/build.sh",
    output:
        PAPER,
    log:
        f"logs/{PLACE}/paper.log",
    benchmark:
        f"logs/{PLACE}/paper.tsv"
    conda:
        "../environment.yml"
    threads: 1
    resources:
        mem_mb=500,
    shell:
        "{input.script:q} {input.text:q} {input.numbers:q} {output:q} > {log:q}"
