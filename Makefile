# Everything runs in a virtual environment of its own; `make run` and `make test` set it up on first use.
VENV ?= .venv
# the first Python of this machine that is new enough
PYTHON ?= $(shell .ci/system python)

# Compiled modules are kept in the environment, also where Python is told to keep none: tests, manual and wheel start
# over a hundred processes, each of which would otherwise compile anew whatever it imports.
export PYTHONDONTWRITEBYTECODE :=
export PYTHONPYCACHEPREFIX := $(abspath $(VENV))/bytecode

PIP = $(VENV)/bin/python -m pip install --quiet --disable-pip-version-check

# One process more than there are cores, since some tests wait. Each has a stretch of the files, and whoever is done takes
# half of what another has left, so that most files stay whole with what their fixtures have made.
PROCESSES ?= $(shell $(PYTHON) -c 'import os; print(os.cpu_count() + 1)')
PYTEST = OPENBLAS_NUM_THREADS=1 $(VENV)/bin/python -m pytest --numprocesses=$(PROCESSES) --dist=worksteal --durations=10

.PHONY: run test test-all test-processors lint house check wheel locks sbom docs pages html try benchmarks system clean

run: $(VENV)/.program
	@$(VENV)/bin/fem-seal run examples/ball_cone.toml

# All but those that take longer than some seconds: whole calculations done twice, all examples, killed processes.
test: $(VENV)/.tools
	@$(PYTEST) -m "not slow"

test-all: $(VENV)/.tools
	@$(PYTEST)

# Last digits differ between processors: the quick tests with all that numpy knows of this one, then without AVX-512.
AVX512 = from numpy._core._multiarray_umath import __cpu_dispatch__ as known, __cpu_features__ as has; \
	print(*(name for name in known if has.get(name) and name.startswith(("X86_V4", "AVX512"))))

test-processors: $(VENV)/.tools
	@NPY_DISABLE_CPU_FEATURES= $(MAKE) --no-print-directory test
	@newer="$$(NPY_DISABLE_CPU_FEATURES= $(VENV)/bin/python -c '$(AVX512)')"; \
	if [ -n "$$newer" ]; then \
		echo "once more without $$newer" && NPY_DISABLE_CPU_FEATURES="$$newer" $(MAKE) --no-print-directory test; \
	else \
		echo "numpy uses no AVX-512 on this processor: the tests of an older processor are those above" >&2; \
	fi

lint: $(VENV)/.tools
	@$(VENV)/bin/ruff check .
	@$(VENV)/bin/ruff format --check .
	@$(VENV)/bin/mypy
	@$(VENV)/bin/lint-imports

# How much code there is and how many files know each option, none above benchmarks/ceilings.toml.
house: $(VENV)/.tools
	@$(VENV)/bin/python benchmarks/house.py --check

check: lint test

# What users install: the wheel in an environment of its own, which sees the dependencies of the first one but not the
# checkout, and the example solved from there. PYTHONS="python3.12 python3.13": in empty environments of these, too, with
# all dependencies from the index, and the light installation from the source distribution.
wheel: $(VENV)/.tools
	@$(VENV)/bin/python tests/wheel.py $(PYTHONS)

# Versions of all packages for all systems, as the tests pass with them, and of those alone that `fem-seal run` needs.
LOCK = $(VENV)/bin/python -m uv pip compile pyproject.toml --quiet --universal --python-version 3.11 --no-header --no-annotate

locks: $(VENV)/.tools
	@$(PIP) uv
	@$(LOCK) --upgrade --all-extras --output-file locks/all.txt
	@$(LOCK) --excludes locks/left_out.txt --constraints locks/all.txt --output-file locks/light.txt

# What an installation consists of, with versions and licences, as CycloneDX: dist/fem-seal.cdx.json.
sbom: $(VENV)/bin/python
	@rm -rf build/sbom && mkdir -p build/sbom dist
	@$(VENV)/bin/python -m venv build/sbom/program && $(VENV)/bin/python -m venv build/sbom/tool
	@build/sbom/program/bin/python -m pip install --quiet --disable-pip-version-check --constraint locks/all.txt .
	@build/sbom/tool/bin/python -m pip install --quiet --disable-pip-version-check cyclonedx-bom
	@build/sbom/tool/bin/cyclonedx-py environment --pyproject pyproject.toml --output-reproducible \
		--output-file dist/fem-seal.cdx.json build/sbom/program/bin/python
	@rm -rf build/sbom
	@echo dist/fem-seal.cdx.json

# The manual, docs/_build/html/index.html: first the pages that are calculated, then all of them as HTML.
docs: pages
	@$(MAKE) --no-print-directory html

pages: export OPENBLAS_NUM_THREADS = 1
pages: $(VENV)/.tools
	@$(VENV)/bin/python docs/make/input_reference.py
	@$(VENV)/bin/python docs/make/reference_pages.py
	@$(VENV)/bin/python docs/make/speed_page.py
	@$(VENV)/bin/python docs/make/gallery.py

# Every warning is an error.
html: $(VENV)/.tools
	@$(VENV)/bin/python -m sphinx -W --keep-going --quiet -b html -d docs/_build/doctrees docs docs/_build/html
	@echo docs/_build/html/index.html

# A page that calculates a leak rate in the browser, served at http://127.0.0.1:8050; its Python (98 MB) is fetched once.
try: $(VENV)/.program
	@$(VENV)/bin/python docs/try/make.py

# Every figure that has a goal beside it, on a machine that does nothing else; ASKED="--quick --record" and the like.
benchmarks: $(VENV)/.tools
	@$(VENV)/bin/python benchmarks/goals.py $(ASKED)

clean:
	rm -rf $(VENV) build *.egg-info .mypy_cache .pytest_cache .ruff_cache .import_linter_cache .hypothesis examples/*.out docs/_build docs/cases docs/reference/api docs/reference/cli.md docs/tutorial/made docs/verification/made

# Libraries and the venv module; as root on Debian or Ubuntu they are installed, otherwise the command is printed.
system:
	@.ci/system program

$(VENV)/bin/python: | system
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
