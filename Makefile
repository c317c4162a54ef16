# nullbody: every command sets up .venv first; the second time that costs nothing.

PYTHON ?= python3
ARGS   ?=

VENV := .venv
ifeq ($(OS),Windows_NT)
  BIN := $(VENV)/Scripts
else
  BIN := $(VENV)/bin
endif
READY := $(VENV)/ready

# The interpreter must be new enough; the environment must have pip.
IS_NEW  := import sys; sys.exit(sys.version_info < (3, 11))
HAS_PIP := import sys, pip; sys.exit(sys.version_info < (3, 11))

.DEFAULT_GOAL := help
.PHONY: help setup reproduce test lint format regenerate pictures bench clean

help: ## list the targets
	@awk -F ':.*## ' '/^[a-z]+:.*## / { printf "  make %-11s %s\n", $$1, $$2 }' $(firstword $(MAKEFILE_LIST))

setup: $(READY) ## create .venv and install nullbody, the engines it is checked against, and the tools

reproduce: $(READY) ## recompute the paper's evidence into out/reproduce (open index.html)
	@$(BIN)/nullbody reproduce --out out/reproduce

test: $(READY) ## run all tests; ARGS="tests/expr -x" narrows it
	@$(BIN)/python -m pytest $(ARGS)

lint: $(READY) ## check format, rules and types; changes nothing
	@$(BIN)/ruff format --check .
	@$(BIN)/ruff check .
	@$(BIN)/mypy

format: $(READY) ## format the code and apply the safe fixes
	@$(BIN)/ruff format .
	@$(BIN)/ruff check --fix .

regenerate: $(READY) ## rewrite the committed golden files that the tests compare with
	@$(BIN)/python -m tests.regenerate

pictures: $(READY) ## draw the pictures of docs/catalog.md again
	@$(BIN)/python -m tests.docs.catalog

bench: $(READY) ## measure speed beside other tools into out/bench (five minutes; ARGS=--quick: a half)
	@$(BIN)/nullbody bench --html out/bench/index.html --json out/bench/bench.json $(ARGS)

clean: ## remove .venv, out and what the tools leave behind
	rm -rf $(VENV) out build dist .pytest_cache .mypy_cache .ruff_cache .hypothesis
	find . -name __pycache__ -type d -prune -exec rm -rf {} +

$(READY): pyproject.toml constraints.txt
	@if ! $(BIN)/python -c '$(HAS_PIP)' >/dev/null 2>&1; then \
	  $(PYTHON) -c 'pass' >/dev/null 2>&1 || { \
	    echo "There is no '$(PYTHON)' here. Install Python 3.11 or newer, or name yours: make PYTHON=/path/to/python3.12"; exit 1; }; \
	  $(PYTHON) -c '$(IS_NEW)' || { \
	    echo "nullbody needs Python 3.11 or newer; '$(PYTHON)' is $$($(PYTHON) --version 2>&1). Name a newer one: make PYTHON=python3.12"; exit 1; }; \
	  $(PYTHON) -m venv --clear $(VENV) || { \
	    echo "$(VENV) could not be made. On Debian and Ubuntu: apt install python3-venv; otherwise name a Python that has venv and pip: make PYTHON=/path/to/python3"; exit 1; }; \
	fi
	@echo "Installing into $(VENV): a minute or two, once."
	@$(BIN)/python -m pip install --quiet --disable-pip-version-check -c constraints.txt -e '.[verify,symbolic,native,optimal,jax,fmu,dev]' || { \
	  echo "The installation failed; the reason is above. Check the network and run make again."; exit 1; }
	@touch $@
