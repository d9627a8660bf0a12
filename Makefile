# Everything starts here: `make` prints what there is. Needs Python 3.11 to 3.13, pip, make and a C++ compiler.

PYTHON ?= python3
VENV   := .venv
BIN    := $(VENV)/bin
# The shell expands $$PWD: the path of this folder may hold spaces, quotes and dollars.
RUN    := PATH="$$PWD/$(BIN):$$PATH"
PYTEST := pytest --numprocesses 2 --dist loadfile --no-loadscope-reorder
SHELL  := /bin/bash

# Written last, so that an interrupted set-up is never taken for a complete one.
ENVIRONMENT := $(VENV)/.environment
READY       := $(VENV)/.ready

.DEFAULT_GOAL := help
.PHONY: help environment report docs lab lint check test search multiverse bench agreement lock clean FORCE
.DELETE_ON_ERROR:

help:
	@echo 'make figures/table1.tex   a table or figure, from runs to LaTeX (any other file of figures/ alike)'
	@echo 'make report               everything on one page: figures/report.html'
	@echo 'make docs                 the documentation as a site: build/site/index.html'
	@echo 'make lab                  play: opens notebooks/explore.ipynb in JupyterLab'
	@echo 'make check                style, types and the fast tests, in under a minute'
	@echo 'make test                 all checks and tests'
	@echo 'make search               which readings of the paper make its baselines: many hours of runs (docs/readings-plan.md)'
	@echo 'make multiverse           each question under 32 readings: hours of runs (docs/readings-plan.md)'
	@echo 'make bench                how fast, beside physics and a peer; ten minutes, writes docs/benchmarks.*'
	@echo 'make agreement            our NEAT beside neat-python 0.92; a quarter of an hour, writes docs/neat-python.csv'
	@echo 'make environment          only set up $(VENV)'
	@echo 'make lock                 add to environment.lock what pyproject.toml needs; UPGRADE=1 renews all of it'
	@echo 'make clean                remove $(VENV) and all caches; results/ and figures/ stay'
	@echo 'PYTHON=python3.12 chooses the Python of $(VENV).'

figures/%: $(READY) FORCE
	$(RUN) snakemake $@

report: $(READY)
	$(RUN) snakemake report

docs: $(READY)
	$(RUN) NO_MKDOCS_2_WARNING=1 mkdocs build --strict --quiet

lab: $(READY)
	$(RUN) JUPYTER_PATH="$$PWD/$(VENV)/share/jupyter" jupyter lab --LabApp.default_url=/lab/tree/notebooks/explore.ipynb \
	    --FileContentsManager.pre_save_hook=neol.study.explore.saving.without_outputs

lint: $(READY)
	$(RUN) ruff check
	$(RUN) ruff format --check
	$(RUN) mypy
	$(RUN) snakefmt --check Snakefile rules

check: lint
	$(RUN) $(PYTEST) -m 'not slow'

test: lint
	$(RUN) snakemake --lint
	$(RUN) NO_MKDOCS_2_WARNING=1 mkdocs build --strict --quiet
	$(RUN) $(PYTEST)

# In the order of config/search/candidates.yaml; what is done is not done again.
search: $(READY)
	$(RUN) bash -o pipefail -c 'python -m neol.study.campaign.search search | xargs --max-lines=1 snakemake'

# The same for config/search/multiverse.yaml.
multiverse: $(READY)
	$(RUN) bash -o pipefail -c 'python -m neol.study.campaign.multiverse | xargs --max-lines=1 snakemake'

# neat-python (the peer) and EnvPool are no dependencies of the library: they are installed here only.
bench: $(READY)
	@$(BIN)/python -m pip install --quiet --disable-pip-version-check --no-deps --require-hashes \
	    --requirement benchmarks/requirements.lock
	$(BIN)/python -m benchmarks.run

# neat-python 0.92 has a folder of its own: the peer is another release of it.
agreement: $(READY)
	@$(BIN)/python -m pip install --quiet --disable-pip-version-check --no-deps --require-hashes --upgrade \
	    --target build/neat-python-0.92 --requirement benchmarks/neat_python_092.lock
	PYTHONPATH=build/neat-python-0.92 $(BIN)/python -m benchmarks.agreement

environment: $(READY)

$(ENVIRONMENT): environment.lock
	@$(PYTHON) -c 'import sys, ensurepip, venv; sys.exit(not (3, 11, 4) <= sys.version_info < (3, 14))' 2>/dev/null || { \
	    echo 'neol needs Python 3.11, 3.12 or 3.13 with venv, and $(PYTHON) is not that: choose one with PYTHON=python3.12' >&2; \
	    exit 1; }
	@echo 'Setting up $(VENV) from environment.lock, for some minutes:'
	@$(PYTHON) -m venv --clear $(VENV)
	@set -o pipefail; $(BIN)/python -m pip install --disable-pip-version-check --no-deps --require-hashes \
	    --progress-bar off --requirement environment.lock | awk '\
	    /^(Collecting|Processing) / && ++n % 30 == 0 { print "  fetched " n " packages"; fflush() } \
	    /^Installing collected/                      { print "  installing " n;          fflush() }'
	@touch $@

CORE        := $(wildcard $(addprefix neol/rollout/worlds/box2d/,*.?pp stub/*.h stub/Box2D/Common/*.h *.lock build.py library.py))

$(READY): $(ENVIRONMENT) pyproject.toml $(CORE)
	@$(BIN)/python -m pip install --quiet --disable-pip-version-check --no-deps --no-build-isolation --editable .
	-@$(BIN)/python -m neol.rollout.worlds.box2d.build
	@touch $@

# uv resolves for every supported Python and system at once; connection-pool and rliable have no wheels.
# What environment.lock pins stays pinned, unless UPGRADE=1 asks for the newest of everything.
lock:
	$(PYTHON) -m venv --clear .venv-lock
	.venv-lock/bin/pip install --quiet --disable-pip-version-check uv==0.13.9
	.venv-lock/bin/uv pip compile pyproject.toml $(if $(UPGRADE),--upgrade) --all-extras --universal --no-emit-index-url --no-annotate \
	    --generate-hashes --only-binary :all: --no-binary connection-pool --no-binary rliable \
	    --custom-compile-command 'make lock' --quiet --output-file environment.lock
	rm -rf .venv-lock

clean:
	rm -rf $(VENV) .venv-lock .snakemake .mypy_cache .pytest_cache .ruff_cache .hypothesis build dist
	find neol tests -name __pycache__ -prune -exec rm -rf {} +
	rm -f neol/rollout/worlds/box2d/core.*so neol/rollout/worlds/box2d/core.dylib
