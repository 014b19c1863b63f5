# Every target sets up what it needs; `make setup` alone does it once.
PYTHON ?= python3
VENV := .venv
BIN := $(VENV)/bin
STAMP := $(VENV)/.installed
PORT ?= 8000
# uv installs several times faster; pip does where there is none. Both say how far they are.
UV := $(shell command -v uv 2>/dev/null)
INSTALL := $(if $(UV),$(UV) pip install --python $(BIN)/python,$(BIN)/python -m pip install --disable-pip-version-check)

.DEFAULT_GOAL := help
.PHONY: help setup serve demo schemas docs test acceptance check bench chaos lock clean

help: ## this list
	@grep -E '^[a-z]+:.*##' $(MAKEFILE_LIST) | sed 's/:.*##/ -/'

$(STAMP): requirements-dev.lock pyproject.toml
	test -x $(BIN)/python || $(PYTHON) -m venv $(VENV)
	$(INSTALL) --require-hashes -r requirements-dev.lock
	$(INSTALL) --no-deps --no-build-isolation --editable .
	touch $@

setup: $(STAMP) ## virtual environment with everything, in .venv

serve: $(STAMP) ## the service on http://127.0.0.1:8000
	$(BIN)/shapersmith serve --port $(PORT)

demo: $(STAMP) ## serve, design the thesis's crane over HTTP, write pictures to demo-output/
	$(BIN)/python -m service.cli.demo demo-output

schemas: $(STAMP) ## JSON Schema of every request and response, in build/schemas/
	$(BIN)/shapersmith schemas -o build/schemas

docs: $(STAMP) ## the documentation as a site, in site/
	$(BIN)/mkdocs build --clean --quiet

test: $(STAMP) ## the tests, within ten minutes on two cores
	$(BIN)/python -m pytest -n 2 --dist worksteal -q --ignore tests/acceptance --ignore tests/contracts

acceptance: $(STAMP) ## whole claims: random designs, tables and moves, kills, the wheel
	$(BIN)/python -m pytest -n 2 --dist worksteal -q tests/acceptance

check: $(STAMP) ## format, lint, types, import rules, docstrings
	$(BIN)/ruff format --check .
	$(BIN)/ruff check .
	$(BIN)/mypy
	$(BIN)/mypy --platform win32 --cache-dir .mypy_cache/win32 shapersmith design schemas service
	$(BIN)/lint-imports
	$(BIN)/python -m pytest -q tests/contracts

bench: $(STAMP) ## speed, beside peers in the same run
	$(BIN)/python -m benchmarks

chaos: $(STAMP) ## what the service withstands: overload, kills, locks
	$(BIN)/python -m benchmarks.chaos

lock: ## resolve the dependencies anew (needs uv)
	uv pip compile --universal --generate-hashes --no-emit-index-url --no-annotate --python-version 3.11 pyproject.toml -o requirements.lock
	uv pip compile --universal --generate-hashes --no-emit-index-url --no-annotate --python-version 3.11 --extra dask --extra postgres -c requirements.lock pyproject.toml -o requirements-extras.lock
	uv pip compile --universal --generate-hashes --no-emit-index-url --no-annotate --python-version 3.11 -c requirements-extras.lock --group dev pyproject.toml -o requirements-dev.lock

clean: ## remove what the other targets made
	rm -rf $(VENV) build dist site demo-output shapersmith-data *.egg-info .pytest_cache .mypy_cache .ruff_cache .hypothesis .import_linter_cache
