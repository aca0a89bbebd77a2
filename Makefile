# Everything runs in a virtual environment of its own; `make run` and `make test` set it up on first use.
VENV ?= .venv
PYTHON ?= python3

PIP = $(VENV)/bin/python -m pip install --quiet --disable-pip-version-check

.PHONY: run test lint check wheel docs clean

run: $(VENV)/.program
	@$(VENV)/bin/fem-seal run examples/ball_cone.toml

test: $(VENV)/.tools
	@OPENBLAS_NUM_THREADS=1 $(VENV)/bin/python -m pytest -n auto --dist loadfile

lint: $(VENV)/.tools
	@$(VENV)/bin/ruff check .
	@$(VENV)/bin/ruff format --check .
	@$(VENV)/bin/mypy
	@$(VENV)/bin/lint-imports

check: lint test

# What users install: the wheel in an environment of its own, which sees the dependencies of the first one but not the
# checkout, and the example solved from there.
wheel: $(VENV)/.tools
	@$(VENV)/bin/python tests/wheel.py

docs: $(VENV)/.tools
	@$(VENV)/bin/python docs/make_input_reference.py

clean:
	rm -rf $(VENV) build *.egg-info .mypy_cache .pytest_cache .ruff_cache .import_linter_cache .hypothesis examples/*.out

$(VENV)/bin/python:
	@$(PYTHON) -c 'import sys; sys.exit(sys.version_info < (3, 11) and "Python 3.11 or newer is needed; name one: make PYTHON=python3.12 ...")'
	@$(PYTHON) -m venv $(VENV)

$(VENV)/.program: pyproject.toml | $(VENV)/bin/python
	@echo "setting up $(VENV) (a few minutes, once)" >&2
	@$(PIP) --editable .
	@touch $@

$(VENV)/.tools: pyproject.toml | $(VENV)/bin/python
	@echo "setting up $(VENV) with the tools for development (a few minutes, once)" >&2
	@$(PIP) --editable '.[dev]'
	@touch $@ $(VENV)/.program
