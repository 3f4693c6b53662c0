# make study   the whole study: tables and figures in results/
# make claims  what it takes to answer the paper's claims: several data sets, in results/claims
# make smoke   a tiny study through every stage, in about a minute
# make talk    a page on which to talk to the robots of a study
# make verify  whether every artifact is what it was when it was made
# make test    the tests
# make compare   which results differ from results/reference by more than the seeds explain
# CACHE=folder names the cache of artifacts (default: in the user's cache folder), CACHE_GIB its size limit
CONFIG ?= config/config.yaml
OUT ?= results
CORES ?=
PORT ?= 8321
PROFILE ?= default
RUN = $(PYTHON) -m workflow run --profile $(PROFILE) $(if $(CORES),--cores $(CORES))

VENV := .venv
READY := $(VENV)/.ready
PYTHON := $(VENV)/bin/python
BENCH_TRIALS := $(foreach D,20 40,features/simulator/D$(D)/train_trials.parquet)
BENCH_FILES = $(foreach trials,$(BENCH_TRIALS:%=$(OUT)/bench/study/%),$(trials) $(trials:trials.parquet=objects.parquet))
SOURCES := data_collection features model evaluation workflow tests benchmarks

.DEFAULT_GOAL := help
.PHONY: help setup study claims smoke snakemake-report compare talk verify cache-info cache-clean test test-slow lint format bench portable scale docs lock reference reference-bench clean

help:
	@echo "make study [CONFIG=$(CONFIG)] [OUT=$(OUT)] [CORES=n] [CACHE=folder]  run a study"
	@echo "make study PROFILE=slurm   the same on a cluster; or a folder with a Snakemake profile of one's own"
	@echo "make claims [OUT=$(OUT)/claims]   the paper's claims over several data sets (config/claims.yaml)"
	@echo "make smoke [OUT=$(OUT)/smoke]   a tiny study through every stage"
	@echo "make compare [OUT=$(OUT)]       which results differ from results/reference by more than the seeds explain"
	@echo "make talk [OUT=$(OUT)] [PORT=$(PORT)]   a page, for this machine alone, on which to tell the robots of a study what to do"
	@echo "make verify [OUT=$(OUT)]   hash every artifact again: what is missing, changed or unexplained"
	@echo "make cache-info | cache-clean [CACHE=folder]   the cache of artifacts that all runs share"
	@echo "make snakemake-report [CONFIG=…] [OUT=…]   the study, and Snakemake's own report of it (workflow, run times, results)"
	@echo "make test | test-slow | lint | format | bench | docs"
	@echo "make scale   a study with ten times the trials and seeds (hours), and what an even larger one would need"
	@echo "make portable   what other processors would make of a study, with and without the pins (an hour and a half)"
	@echo "make lock    pin the newest versions that pyproject.toml allows in environment.lock"
	@echo "make reference | reference-bench   run the study, or the benchmarks, and keep what they show in results/reference"
	@echo "make clean   remove results but results/reference"

# Everything is pinned in environment.lock and installed in a private environment. PyBullet has no wheels for
# Pythons above 3.11. A set-up that was interrupted has no stamp, and begins again.
$(READY): environment.lock
	@rm -rf $(VENV)
	@if command -v python3.11 >/dev/null && python3.11 -c 'import ensurepip' 2>/dev/null; then \
		echo "Setting up $(VENV) with python3.11 (about two minutes)"; python3.11 -m venv $(VENV); \
	elif command -v uv >/dev/null; then \
		echo "Setting up $(VENV) with a Python 3.11 of uv (about two minutes)"; uv venv --quiet --seed --python 3.11 $(VENV); \
	else \
		echo "This project needs Python 3.11 (PyBullet has no wheels for newer ones), and found neither it nor uv." >&2; \
		echo "Install one of them (python3.11 with its venv module): Debian 12 or Ubuntu with a 3.11 package: apt install python3.11 python3.11-venv;" >&2; \
		echo "any system: pip install uv, which fetches Python 3.11 by itself." >&2; exit 1; \
	fi
	@$(PYTHON) -m pip install --quiet --disable-pip-version-check -r environment.lock
	@echo "Compiling the samplers (one to two minutes, once)"
	@$(PYTHON) -c "from model.fitting import prepare; prepare()"
	@touch $@

setup: $(READY)

study: $(READY)
	@$(RUN) --config $(CONFIG) --out $(OUT)

claims: $(READY)
	@$(RUN) --config config/claims.yaml --out $(if $(filter results,$(OUT)),results/claims,$(OUT))

smoke: $(READY)
	@$(RUN) --config config/smoke.yaml --out $(if $(filter results,$(OUT)),results/smoke,$(OUT))

# Exits with 1 where something differs, with 2 where there is nothing to compare; make itself then says 2.
compare: $(READY)
	@$(PYTHON) -m evaluation compare $(OUT) results/reference

talk: $(READY)
	@$(PYTHON) -m evaluation talk $(OUT) --port $(PORT)

verify: $(READY)
	@$(PYTHON) -m workflow verify --out $(OUT)

# CACHE and CACHE_GIB reach the program as environment variables, from here and from `make study` alike.
cache-info cache-clean: $(READY)
	@$(PYTHON) -m workflow $@

snakemake-report: study
	@$(PYTHON) -m workflow run --config $(CONFIG) --out $(OUT) -- --report snakemake_report.html

test: $(READY)
	$(PYTHON) -m pytest -n 2 --dist loadfile -m "not slow" tests

test-slow: $(READY)
	$(PYTHON) -m pytest -n 2 --dist loadfile -m slow tests

lint: $(READY)
	$(VENV)/bin/ruff check $(SOURCES)
	$(VENV)/bin/ruff format --check $(SOURCES)
	$(VENV)/bin/mypy $(SOURCES)
	$(VENV)/bin/snakefmt --check Snakefile workflow/rules
	.ci/lint_snakefile
	$(PYTHON) .ci/private_names

format: $(READY)
	$(VENV)/bin/ruff check --fix $(SOURCES)
	$(VENV)/bin/ruff format $(SOURCES)
	$(VENV)/bin/snakefmt Snakefile workflow/rules

# The samplers are compared on the study's features: from the cache after a study, simulated in a few minutes without.
bench: $(READY)
	$(PYTHON) -m benchmarks.jobs $(OUT) --out $(OUT)/bench
	test ! -f $(OUT)/bench/jobs.csv -o ! -f $(OUT)/manifest.json || $(PYTHON) -m benchmarks.scale needs $(OUT) --times 1000 > $(OUT)/bench/needs.md
	$(PYTHON) -m benchmarks --out $(OUT)/bench
	$(RUN) --config config/config.yaml --out $(OUT)/bench/study -- $(BENCH_TRIALS)
	$(PYTHON) -m benchmarks.samplers --out $(OUT)/bench $(BENCH_FILES)
	$(PYTHON) -m benchmarks.convergence --out $(OUT)/bench $(BENCH_FILES)

# What hangs on the kernels that libraries choose for a processor, and that jobs do not: the table of docs/portable.md.
portable: $(READY)
	@rm -rf $(OUT)/portable
	@mkdir -p $(OUT)/portable
	$(PYTHON) -m tests.workflow.portable --out $(OUT)/portable
	$(PYTHON) -m tests.workflow.portable --out $(OUT)/portable --scores

# Ten times the trials and ten times the seeds, and what a study that is again ten times as large would need.
scale: $(READY)
	@mkdir -p $(OUT)/bench
	$(PYTHON) -m benchmarks.scale config $(CONFIG) --trials 10 --seeds 10 > $(OUT)/bench/scale.yaml
	$(RUN) --config $(OUT)/bench/scale.yaml --out $(OUT)/scale
	$(PYTHON) -m benchmarks.scale needs $(OUT)/scale --times 10 > $(OUT)/bench/scale.md

docs: $(READY)
	$(PYTHON) -m workflow.plan.reference docs/config.md config/config.schema.json

# pip-compile resolves with pip itself; a local build label such as +cpu is on no public index, and is left out.
lock:
	python3.11 -m venv $(VENV)-lock
	$(VENV)-lock/bin/python -m pip install --quiet pip-tools==7.6.2
	$(VENV)-lock/bin/pip-compile --quiet --upgrade --extra dev --strip-extras --allow-unsafe --no-emit-options \
		--no-emit-index-url --no-emit-find-links --no-emit-trusted-host --output-file environment.lock pyproject.toml
	sed -i 's/^\(torch==[0-9.]*\)+[a-z0-9]*/\1/' environment.lock
	rm -rf $(VENV)-lock

# What is committed of a full run, for people who want to look before they run.
reference: study
	@rm -rf results/reference/tables results/reference/figures
	@mkdir -p results/reference/figures
	@cp $(OUT)/figures/*.png $(OUT)/figures/*.gif results/reference/figures/
	@cp -r $(OUT)/tables $(OUT)/scores.csv $(OUT)/claims*.csv results/reference/

# The same of the benchmarks, which are to be measured on an idle machine.
reference-bench: bench
	@mkdir -p results/reference/bench
	@cp $(OUT)/bench/*.csv $(OUT)/bench/*.md $(OUT)/bench/*.png results/reference/bench/

clean:
	@find results -mindepth 1 -maxdepth 1 ! -name reference -exec rm -rf {} + 2>/dev/null || true
