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
UNTIL ?=
PORT ?= 8321
PROFILE ?= default
# What people give is one word of the shell each, whatever stands in it: $(value …) keeps make from expanding it.
quoted = '$(subst ','\'',$(1))'
CONFIG_WORD := $(call quoted,$(value CONFIG))
OUT_WORD := $(call quoted,$(value OUT))
# A target with a folder of its own uses it where no other is named.
ifeq ($(value OUT),results)
OWN_OUT = $(call quoted,results/$(1))
else
OWN_OUT = $(OUT_WORD)
endif
RUN = $(PYTHON) -m workflow run --profile $(call quoted,$(value PROFILE)) $(if $(value CORES),--cores $(call quoted,$(value CORES)))

VENV := .venv
READY := $(VENV)/.ready
PYTHON := $(VENV)/bin/python
BENCH_TRIALS := $(foreach D,20 40,features/simulator/D$(D)/train_trials.parquet)
BENCH_FILES = $(foreach trials,$(BENCH_TRIALS:%=bench/study/%),$(OUT_WORD)/$(trials) $(OUT_WORD)/$(trials:trials.parquet=objects.parquet))
SOURCES := data_collection features model evaluation workflow tests benchmarks

.DEFAULT_GOAL := help
.PHONY: FORCE help setup study claims smoke snakemake-report compare talk verify cache-info cache-clean test test-slow lint format bench portable scale docs lock reference reference-bench clean

help:
	@echo "make study [CONFIG=config/config.yaml] [OUT=results] [CORES=n] [CACHE=folder]  run a study"
	@echo "make study PROFILE=slurm   the same on a cluster; or a folder with a Snakemake profile of one's own"
	@echo "make claims [OUT=results/claims] [UNTIL=n]   the paper's claims over several data sets (config/claims.yaml), or as many as decide them, at most n"
	@echo "make smoke [OUT=results/smoke]   a tiny study through every stage"
	@echo "make compare [OUT=results]       which results differ from results/reference by more than the seeds explain"
	@echo "make talk [OUT=results] [PORT=8321]   a page, for this machine alone, on which to tell the robots of a study what to do"
	@echo "make verify [OUT=results]   hash every artifact again: what is missing, changed or unexplained"
	@echo "make cache-info | cache-clean [CACHE=folder]   the cache of artifacts that all runs share"
	@echo "make snakemake-report [CONFIG=…] [OUT=…]   the study, and Snakemake's own report of it (workflow, run times, results)"
	@echo "make test | test-slow | lint | format | bench | docs"
	@echo "make scale   a study with ten times the trials and seeds (hours), and what an even larger one would need"
	@echo "make portable   what other processors would make of a study, with and without the pins (an hour and a half)"
	@echo "make lock    pin the newest versions that pyproject.toml allows in environment.lock"
	@echo "make reference | reference-bench   run the study, or the benchmarks, and keep what they show in results/reference"
	@echo "make clean YES=1   remove results but results/reference; without YES=1, list them"

# Everything is pinned in environment.lock and installed in a private environment. PyBullet has no wheels for
# Pythons above 3.11. The lock's hash decides whether that has to be done, see .ci/environment.
$(READY): FORCE
	@.ci/environment

FORCE:

setup: $(READY)

study: $(READY)
	@$(RUN) --config $(CONFIG_WORD) --out $(OUT_WORD)

claims: $(READY)
	@$(RUN) --config config/claims.yaml --out $(call OWN_OUT,claims) $(if $(value UNTIL),--until-decided $(call quoted,$(value UNTIL)))

smoke: $(READY)
	@$(RUN) --config config/smoke.yaml --out $(call OWN_OUT,smoke)

# Exits with 1 where something differs, with 2 where there is nothing to compare; make itself then says 2.
compare: $(READY)
	@$(PYTHON) -m evaluation compare $(OUT_WORD) results/reference

talk: $(READY)
	@$(PYTHON) -m evaluation talk $(OUT_WORD) --port $(call quoted,$(value PORT))

verify: $(READY)
	@$(PYTHON) -m workflow verify --out $(OUT_WORD)

# CACHE and CACHE_GIB reach the program as environment variables, from here and from `make study` alike.
cache-info cache-clean: $(READY)
	@$(PYTHON) -m workflow $@

snakemake-report: study
	@$(PYTHON) -m workflow run --config $(CONFIG_WORD) --out $(OUT_WORD) -- --report snakemake_report.html

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
	$(PYTHON) -m benchmarks.jobs $(OUT_WORD) --out $(OUT_WORD)/bench
	test ! -f $(OUT_WORD)/bench/jobs.csv -o ! -f $(OUT_WORD)/manifest.json || $(PYTHON) -m benchmarks.scale needs $(OUT_WORD) --times 1000 > $(OUT_WORD)/bench/needs.md
	$(PYTHON) -m benchmarks --out $(OUT_WORD)/bench
	$(RUN) --config config/config.yaml --out $(OUT_WORD)/bench/study -- $(BENCH_TRIALS)
	$(PYTHON) -m benchmarks.samplers --out $(OUT_WORD)/bench $(BENCH_FILES)
	$(PYTHON) -m benchmarks.convergence --out $(OUT_WORD)/bench $(BENCH_FILES)

# What hangs on the kernels that libraries choose for a processor, and that jobs do not: the table of docs/portable.md.
portable: $(READY)
	@rm -rf $(OUT_WORD)/portable
	@mkdir -p $(OUT_WORD)/portable
	$(PYTHON) -m tests.workflow.portable --out $(OUT_WORD)/portable
	$(PYTHON) -m tests.workflow.portable --out $(OUT_WORD)/portable --scores

# Ten times the trials and ten times the seeds, and what a study that is again ten times as large would need.
scale: $(READY)
	@mkdir -p $(OUT_WORD)/bench
	$(PYTHON) -m benchmarks.scale config $(CONFIG_WORD) --trials 10 --seeds 10 > $(OUT_WORD)/bench/scale.yaml
	$(RUN) --config $(OUT_WORD)/bench/scale.yaml --out $(OUT_WORD)/scale
	$(PYTHON) -m benchmarks.scale needs $(OUT_WORD)/scale --times 10 > $(OUT_WORD)/bench/scale.md

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
	@cp $(OUT_WORD)/figures/*.png $(OUT_WORD)/figures/*.gif results/reference/figures/
	@cp -r $(OUT_WORD)/tables $(OUT_WORD)/scores.csv $(OUT_WORD)/variance.* $(OUT_WORD)/claims*.csv results/reference/

# The same of the benchmarks, which are to be measured on an idle machine.
reference-bench: bench
	@mkdir -p results/reference/bench
	@cp $(OUT_WORD)/bench/*.csv $(OUT_WORD)/bench/*.md $(OUT_WORD)/bench/*.png results/reference/bench/

# Results may be hours of work: they are listed, and removed only where that is asked for.
clean:
ifeq ($(value YES),1)
	@find results -mindepth 1 -maxdepth 1 ! -name reference -exec rm -rf {} + 2>/dev/null || true
else
	@find results -mindepth 1 -maxdepth 1 ! -name reference -exec du -sh {} + 2>/dev/null || true
	@echo "make clean YES=1 removes these"
endif
