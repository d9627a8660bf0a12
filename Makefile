# Entry points of the project; `make` lists them. Needs Python 3.11 to 3.13, pip, make and a C++ compiler.

PYTHON ?= python3
VENV   := .venv
BIN    := $(VENV)/bin
# The shell expands $$PWD: the path of this folder may hold spaces, quotes and dollars.
RUN    := PATH="$$PWD/$(BIN):$$PATH"
PYTEST := pytest --numprocesses 2 --dist loadfile --no-loadscope-reorder
SHELL  := /bin/bash

# Written last, so that an interrupted setup never counts as complete.
ENVIRONMENT := $(VENV)/.environment
READY       := $(VENV)/.ready

.DEFAULT_GOAL := help
.PHONY: help environment report docs lab lint check test search multiverse bench agreement lock clean FORCE
.DELETE_ON_ERROR:

help:
	@echo 'make figures/table1.tex   make a table or figure from its runs (or any other file of figures/)'
	@echo 'make report               make one page with all results: figures/report.html'
	@echo 'make docs                 build the documentation: build/site/index.html'
	@echo 'make lab                  open notebooks/explore.ipynb in JupyterLab'
	@echo 'make check                check style and types, run the fast tests; two minutes'
	@echo 'make test                 run all checks and tests'
	@echo 'make search               find readings that reproduce the baselines; hours (docs/readings-plan.md)'
	@echo 'make multiverse           ask each question under 32 readings; an hour (docs/readings-plan.md)'
	@echo 'make bench                measure speed; ten minutes, writes docs/benchmarks.*'
	@echo 'make agreement            compare our NEAT with neat-python 0.92; minutes, writes docs/neat-python.csv'
	@echo 'make environment          set up $(VENV) only'
	@echo 'make lock                 add new dependencies to environment.lock; UPGRADE=1 updates all of it'
	@echo 'make clean                remove $(VENV) and all caches; keeps results/ and figures/'
	@echo 'PYTHON=python3.12 selects the Python of $(VENV).'

figures/%: $(READY) FORCE
	$(RUN) snakemake $@
	@for page in '$(basename $@)'.md '$(basename $@)'.png; do \
	    if [ -e "$$page" ]; then echo "To look at it, open $$page"; fi; \
	done

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

# In the order of config/search/candidates.yaml; finished runs are kept.
search: $(READY)
	$(RUN) bash -o pipefail -c 'python -m neol.study.campaign.search search | xargs --no-run-if-empty --max-lines=1 snakemake'

# The same for config/search/multiverse.yaml.
multiverse: $(READY)
	$(RUN) bash -o pipefail -c 'python -m neol.study.campaign.multiverse | xargs --no-run-if-empty --max-lines=1 snakemake'

# neat-python (the peer) and EnvPool are not dependencies of the library; only this target installs them.
bench: $(READY)
	@$(BIN)/python -m pip install --quiet --disable-pip-version-check --no-deps --require-hashes \
	    --requirement benchmarks/requirements.lock
	$(BIN)/python -m benchmarks.run

# neat-python 0.92 has its own folder, because the peer is another release.
agreement: $(READY)
	@$(BIN)/python -m pip install --quiet --disable-pip-version-check --no-deps --require-hashes --upgrade \
	    --target build/neat-python-0.92 --requirement benchmarks/neat_python_092.lock
	PYTHONPATH=build/neat-python-0.92 $(BIN)/python -m benchmarks.agreement

environment: $(READY)

# What has no wheel is built with build.lock: build isolation would fetch a setuptools that is not pinned.
$(ENVIRONMENT): environment.lock build.lock
	@$(PYTHON) -c 'import sys, ensurepip, venv; sys.exit(not (3, 11, 4) <= sys.version_info < (3, 14))' 2>/dev/null || { \
	    echo 'neol needs Python 3.11, 3.12 or 3.13 with venv, which $(PYTHON) is not; choose one with PYTHON=python3.12' >&2; \
	    exit 1; }
	@echo 'Setting up $(VENV) from environment.lock (a few minutes):'
	@$(PYTHON) -m venv --clear $(VENV)
	@$(BIN)/python -m pip install --quiet --disable-pip-version-check --no-deps --require-hashes --requirement build.lock
	@set -o pipefail; $(BIN)/python -m pip install --disable-pip-version-check --no-deps --require-hashes \
	    --no-build-isolation --progress-bar off --requirement environment.lock | awk '\
	    /^(Collecting|Processing) / && ++n % 30 == 0 { print "  fetched " n " packages"; fflush() } \
	    /^Installing collected/                      { print "  installing " n;          fflush() }'
	@touch $@

CORE        := $(wildcard $(addprefix neol/rollout/worlds/box2d/,*.?pp stub/*.h stub/Box2D/Common/*.h *.lock build.py library.py))

$(READY): $(ENVIRONMENT) pyproject.toml $(CORE)
	@$(BIN)/python -m pip install --quiet --disable-pip-version-check --no-deps --no-build-isolation --editable .
	-@PIP_NO_BUILD_ISOLATION=0 $(BIN)/python -m neol.rollout.worlds.box2d.build
	@touch $@

# uv resolves for every supported Python and system at once; connection-pool and rliable have no wheels.
# Pinned versions stay in environment.lock; UPGRADE=1 replaces all by the newest ones.
lock:
	$(PYTHON) -m venv --clear .venv-lock
	.venv-lock/bin/pip install --quiet --disable-pip-version-check --no-deps --require-hashes --requirement lock.lock
	.venv-lock/bin/uv pip compile pyproject.toml $(if $(UPGRADE),--upgrade) --all-extras --universal --no-emit-index-url --no-annotate \
	    --generate-hashes --only-binary :all: --no-binary connection-pool --no-binary rliable \
	    --custom-compile-command 'make lock' --quiet --output-file environment.lock
	rm -rf .venv-lock

clean:
	rm -rf $(VENV) .venv-lock .snakemake .mypy_cache .pytest_cache .ruff_cache .hypothesis build dist
	find neol tests -name __pycache__ -prune -exec rm -rf {} +
	rm -f neol/rollout/worlds/box2d/core.*so neol/rollout/worlds/box2d/core.dylib
