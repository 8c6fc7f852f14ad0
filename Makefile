# Needs Python >= 3.11 and make; everything else is put into .venv. `make help` lists the targets.

SHELL := /bin/sh
.DEFAULT_GOAL := help
.DELETE_ON_ERROR:

VENV := .venv
BIN := $(VENV)/bin
PIP := $(BIN)/python -m pip --disable-pip-version-check --no-input -qq
RULEBASE := rulebases/diagonal.yaml
# Pyright runs as installed: it neither looks for a newer release nor downloads Node.js (its package brings both).
export PYRIGHT_PYTHON_IGNORE_WARNINGS := 1

.PHONY: help run install test check format bench bench-ui torture soak package fuzz screenshot browser clean

help:  ## list the targets
	@sed -n 's/^\([a-z-]*\):.*## \(.*\)/make \1|\2/p' $(MAKEFILE_LIST) | awk -F '|' '{printf "  %-16s %s\n", $$1, $$2}'

run: $(VENV)/installed  ## start the workbench on http://127.0.0.1:8080 (RULEBASE=... opens another file)
	@exec $(BIN)/fuzzy-workbench serve $(RULEBASE) --open

install: $(VENV)/installed  ## create .venv with the program in it, nothing more

test: check browser  ## check the sources, then run all tests (Chromium is installed where it is missing)
	@$(BIN)/python -m pytest

check: $(VENV)/installed-dev  ## ruff format, ruff and pyright over all sources
	@$(BIN)/ruff format --check --quiet || { echo "make: run 'make format' to format the files" >&2; exit 1; }
	@$(BIN)/ruff check --quiet
	@$(BIN)/pyright

format: $(VENV)/installed-dev  ## format the sources
	@$(BIN)/ruff format
	@$(BIN)/ruff check --fix

bench: $(VENV)/installed-dev  ## print how fast inference, simulation and editing are on this machine
	@$(BIN)/python -m benchmarks

bench-ui: $(VENV)/installed-dev browser  ## print how soon the page answers while a slider is dragged, in a real browser
	@$(BIN)/python -m benchmarks ui

torture: $(VENV)/installed-dev  ## kill 500 editing sessions and see that nothing is lost (eight minutes; COUNT=... for fewer)
	@$(BIN)/python -m tests.torture $(or $(COUNT),500)

soak: $(VENV)/installed-dev  ## ten minutes of editing and playback with 20 browsers (MINUTES=... for another time)
	@$(BIN)/python -m tests.soak $(or $(MINUTES),10)

package: $(VENV)/installed-dev  ## build the wheel, install it into an empty environment and try it there
	@$(BIN)/python -m tests.package

fuzz: $(VENV)/installed-dev  ## read a hundred thousand damaged files of every format
	@FUZZ_EXAMPLES=100000 $(BIN)/python -m pytest tests/formats/test_fuzz.py

screenshot: $(VENV)/installed-dev browser  ## take the pictures in docs again, through the browser tests
	@$(BIN)/python -m pytest tests/e2e/test_tutorial.py tests/e2e/test_workbench.py
	@cp tests/e2e/shots/workbench.png docs/screenshot.png
	@cp tests/e2e/shots/guide-*.png docs/

browser: $(VENV)/installed-dev
	@$(BIN)/python -m tests.e2e.browser

clean:  ## delete .venv and everything that a run left behind
	@rm -rf $(VENV) build dist *.egg-info .pytest_cache .ruff_cache .hypothesis tests/e2e/shots
	@find . -name __pycache__ -type d -prune -exec rm -rf {} +

# The stamps' time is the last installation's: with an unchanged pyproject.toml nothing is installed again.
$(VENV)/installed: pyproject.toml $(VENV)/pyvenv.cfg
	@echo "Installing into $(VENV) (once; a minute or two) ..."
	@$(PIP) install --editable .
	@touch $@

$(VENV)/installed-dev: pyproject.toml $(VENV)/pyvenv.cfg
	@echo "Installing the program and what its tests need into $(VENV) (once; a minute or two) ..."
	@$(PIP) install --editable '.[dev]'
	@touch $@ $(VENV)/installed

# PYTHON=... names an interpreter; otherwise the first that works, is new enough and can make environments.
$(VENV)/pyvenv.cfg:
	@for python in $(PYTHON) python3.13 python3.12 python3.11 python3 python; do \
	    "$$python" -c 'import sys; sys.exit(sys.version_info < (3, 11))' 2>/dev/null || continue; \
	    "$$python" -c 'import ensurepip, venv' 2>/dev/null || { lame=$$python; continue; }; \
	    exec "$$python" -m venv --clear $(VENV); \
	done; \
	if [ -n "$$lame" ]; \
	then echo "make: $$lame cannot create environments; install its venv module (Debian: apt-get install python3-venv)" >&2; \
	else echo "make: needs Python 3.11 or later and found none; install it, or name one: make PYTHON=/path/to/python3" >&2; \
	fi; \
	exit 1
