# `make help` lists what there is. Everything installs what it needs into .venv.
SHELL := /bin/sh
.DEFAULT_GOAL := help
VENV := .venv
BIN := $(VENV)/bin
OUTPUT ?= outputs
PYTHONS := $(PYTHON) python3 python3.13 python3.12 python3.11 python

.PHONY: help
help: ## list the targets
	@grep -hE '^[a-z-]+:.*## ' Makefile | sed 's/:.*## /\t/' | awk -F '\t' '{printf "make %-11s %s\n", $$1, $$2}'

# These give computing times, or take both cores, so they run alone; the others two at a time.
TIMED := table1 drives drives_enclosed s04_drives s04_table1 m22 m22_concave field
# What no paper has: one decision at a time, many settings, a GPU's many seeds; each takes minutes of its own.
OWN := drive_choices s04_sweep tune table1_million landscape
OTHERS := $(filter-out $(TIMED) $(OWN),$(basename $(notdir $(wildcard conf/experiment/*.yaml))))

.PHONY: paper
paper: $(VENV)/ready ## do every published experiment and build the report (ten to fifteen minutes)
	@for name in $(TIMED); do \
	  echo "experiment $$name"; $(BIN)/gapath experiment=$$name output="$(OUTPUT)" || exit $$?; \
	done
	@echo "experiments $(OTHERS), two at a time"
	@printf '%s\n' $(OTHERS) | xargs -P 2 -I NAME $(BIN)/gapath experiment=NAME output="$(OUTPUT)"
	@$(BIN)/gapath-report "$(OUTPUT)"

# Each map, or each kind of planner, is an experiment of its own: conf/experiment/unseen/*.yaml is what they share.
UNSEEN := $(sort $(patsubst conf/experiment/%.yaml,%,$(wildcard conf/experiment/unseen/*/*.yaml)))

.PHONY: unseen
unseen: $(VENV)/ready ## public maps that were not chosen, from GAPATH_DATA (some ten minutes)
	@for name in $(UNSEEN); do \
	  echo "experiment $$name"; $(BIN)/gapath experiment=$$name output="$(OUTPUT)" || exit $$?; \
	done
	@$(BIN)/gapath-report "$(OUTPUT)"

# Each map, or each kind of maps, is an experiment of its own; conf/experiment/field.yaml, which needs no data, is among those of paper.
FIELD := $(sort $(patsubst conf/experiment/%.yaml,%,$(wildcard conf/experiment/field/*/*.yaml)))

.PHONY: field
field: $(VENV)/ready ## whole scenarios and large maps: planners side by side, from GAPATH_DATA
	@for name in $(FIELD); do \
	  echo "experiment $$name"; $(BIN)/gapath experiment=$$name output="$(OUTPUT)" || exit $$?; \
	done
	@$(BIN)/gapath-report "$(OUTPUT)"

.PHONY: choices
choices: $(VENV)/ready ## vary what KG18 leaves open, one decision at a time (some four minutes)
	@$(BIN)/gapath experiment=drive_choices output="$(OUTPUT)"
	@$(BIN)/gapath-report "$(OUTPUT)"

.PHONY: sweep
sweep: $(VENV)/ready ## vary what S04 leaves open: 36 settings of 24 cells (some ten minutes)
	@$(BIN)/gapath experiment=s04_sweep output="$(OUTPUT)"
	@$(BIN)/gapath-report "$(OUTPUT)"

# After paper, unseen and choices, or some of them: of what was not run the tables stay as they are. ACCEPT names tables, or is all.
.PHONY: numbers
numbers: $(VENV)/ready ## which numbers of the pages do new runs no longer give? ACCEPT=all takes the new ones
	@$(BIN)/python tests/pages/renew.py "$(OUTPUT)" $(if $(ACCEPT),--accept $(ACCEPT))

.PHONY: test
test: $(VENV)/ready ## run all tests
	@$(BIN)/python -m pytest

.PHONY: test-cuda
test-cuda: $(VENV)/ready ## try KG18's evolution on this machine's GPU; without one its tests say what is missing
	@$(BIN)/python -m pytest -n 0 -rs tests/kernels/cuda

.PHONY: test-long
test-long: $(VENV)/ready ## run all tests, on all maps and instances; before a release
	@GAPATH_TESTS=long $(BIN)/python -m pytest

.PHONY: reproduce
reproduce: $(VENV)/ready ## do every published experiment, small, and compare with its golden hashes (three minutes)
	@GAPATH_TESTS=long $(BIN)/python -m pytest --tb=no --figures tests/test_golden.py -k an_experiment

# One after the other, since some measure memory or time, and some take both cores.
.PHONY: reliability
reliability: $(VENV)/ready ## try at length what docs/reliability.md promises; a line for each harness
	@GAPATH_RELIABILITY=long $(BIN)/python -m pytest -n 0 --figures tests/reliability

# Kernels on vectors, which only the compiler understands, are left out.
.PHONY: mutants
mutants: $(VENV)/ready ## change kernels one place at a time; which changes does no test notice?
	@nice -n 19 $(BIN)/python tests/kernels/mutants.py

.PHONY: docs
docs: $(VENV)/ready ## build the site of the pages into build/site; a warning is an error (half a minute)
	@NO_MKDOCS_2_WARNING=1 $(BIN)/mkdocs build --quiet -f docs/site/mkdocs.yml
	@echo "read it: build/site/index.html"

# Nothing sees into a compiled kernel, so the tests of kernels run once more without the compiler:
# some two minutes. test_evaluation would take many more, as would planners and drives, whose kernels
# a test of test_golden runs without it. Kernels on vectors, which only the compiler understands,
# count as missed: most of evaluation.
.PHONY: coverage
coverage: $(VENV)/ready ## measure which lines the tests run; into build/coverage (about ten minutes)
	@$(BIN)/coverage erase
	@NUMBA_DISABLE_JIT=1 $(BIN)/coverage run -m pytest tests/kernels \
	  --ignore tests/kernels/kg18/test_evaluation.py
	@$(BIN)/coverage run -m pytest
	@$(BIN)/coverage combine --quiet
	@$(BIN)/coverage html --quiet
	@$(BIN)/coverage report --skip-covered
	@echo "line by line: build/coverage/index.html"

.PHONY: reference
reference: $(VENV)/ready ## write the pages of settings, columns and messages anew, from the sources
	@$(BIN)/python -m gapath.reference docs

.PHONY: check
check: $(VENV)/ready ## lint, check formats, types and the borders between layers
	@$(BIN)/ruff check
	@$(BIN)/ruff format --check
	@$(BIN)/mypy
	@$(BIN)/lint-imports

.PHONY: hooks
hooks: $(VENV)/ready ## check before each commit, too (.pre-commit-config.yaml)
	@$(BIN)/pre-commit install

.PHONY: bench
bench: $(VENV)/ready ## measure against rivals and the paper; ratios, into outputs/bench
	@$(BIN)/python -m benchmarks --output "$(OUTPUT)/bench"

.PHONY: bench-quick
bench-quick: $(VENV)/ready ## check that the rivals agree; no figures, into outputs/bench-quick
	@$(BIN)/python -m benchmarks --output "$(OUTPUT)/bench-quick" --quick

.PHONY: report
report: $(VENV)/ready ## build the report from whatever runs are there
	@$(BIN)/gapath-report "$(OUTPUT)"

.PHONY: golden
golden: $(VENV)/ready ## accept today's results as the golden ones; look at the difference
	@$(BIN)/python -m pytest -n 0 tests/test_golden.py --update-golden

.PHONY: setup
setup: $(VENV)/ready ## make the environment, .venv

.PHONY: clean
clean: ## remove the environment; outputs stay
	rm -rf $(VENV)

$(VENV)/ready: requirements.lock pyproject.toml
	@set -e; found=; for python in $(PYTHONS); do \
	  if $$python -c 'import sys, venv, ensurepip; sys.exit(not (3, 11) <= sys.version_info[:2] <= (3, 13))' 2>/dev/null; \
	  then found=$$python; break; fi; \
	done; \
	if [ -z "$$found" ]; then \
	  echo "gapath needs Python 3.11, 3.12 or 3.13 with its venv module (Debian: python3-venv)." >&2; \
	  echo "Tried: $(PYTHONS). Name another one: make PYTHON=/path/to/python ..." >&2; exit 2; \
	fi; \
	echo "making $(VENV) with $$($$found --version), about two minutes"; \
	rm -rf $(VENV); $$found -m venv $(VENV); \
	$(BIN)/python -m pip install --quiet --disable-pip-version-check --use-pep517 -r requirements.lock; \
	$(BIN)/python -m pip install --quiet --disable-pip-version-check --no-deps --no-build-isolation -e .; \
	touch $(VENV)/ready
