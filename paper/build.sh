#!/usr/bin/env bash
# Usage: paper/build.sh reproduction.tex results.tex OUTPUT.pdf   (from the root; LaTeX works where results.tex lies)
set -euo pipefail
text=$1 folder=$(dirname "$2") output=$3

if ! { command -v latexmk && command -v pdflatex; }; then
    echo "neol: $output needs LaTeX; on Debian or Ubuntu:" \
        "apt install latexmk texlive-latex-recommended texlive-fonts-recommended" >&2
    exit 1
fi
# LaTeX would take a comma in a folder's name, as there is for some tasks of a budget, for a list of folders.
inputs=$(mktemp -d)
trap 'rm -r "$inputs"' EXIT
cp "$2" "$inputs"
# Without a date the same sources make the same bytes.
export SOURCE_DATE_EPOCH=0 FORCE_SOURCE_DATE=1 TEXINPUTS="$inputs:"
if ! latexmk -g -pdf -interaction=nonstopmode -halt-on-error -outdir="$folder" "$text"; then
    echo "neol: $output: LaTeX failed: $(grep -m 1 '^!' "$folder/reproduction.log" || echo 'see its log')" >&2
    exit 1
fi
cp "$folder/$(basename "$text" .tex).pdf" "$output"
