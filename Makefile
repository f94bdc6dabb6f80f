# make run    the main job on examples/
# make test   format, types and all tests, with the compiled kernels and without
# make bench  benchmarks, as ratios
# make docs   the reference pages, from the tables

PYTHON ?= python3
VENV := .venv
BIN := $(VENV)/bin
SOURCES := pyproject.toml setup.py $(wildcard src/aircut/kernels/*.py)
EXAMPLES := $(sort $(wildcard examples/*.ngc))

.PHONY: run test bench docs clean

$(BIN)/aircut: $(SOURCES)
	test -x $(BIN)/python || $(PYTHON) -m venv $(VENV)
	$(BIN)/python -m pip install --quiet --upgrade pip
	$(BIN)/python -m pip install --quiet -e .
	$(BIN)/python -m compileall -q src
	touch $@

$(VENV)/.tested: $(BIN)/aircut
	$(BIN)/python -m pip install --quiet -e '.[test]'
	touch $@

run: $(BIN)/aircut
	mkdir -p out
	set -e; for file in $(EXAMPLES); do \
	  echo; echo "== $$file"; \
	  $(BIN)/aircut run $$file; \
	  $(BIN)/aircut plot $$file -o out/$$(basename $$file .ngc).html; \
	  $(BIN)/aircut plot $$file -o out/$$(basename $$file .ngc).png; \
	done; echo; echo "pictures are in out/"

test: $(VENV)/.tested
	$(BIN)/ruff check .
	$(BIN)/ruff format --check .
	$(BIN)/mypy
	AIRCUT_PYTHON_KERNELS=1 $(BIN)/python -m pytest tests/test_conformance.py tests/test_api.py
	$(BIN)/python -m pytest

bench: $(BIN)/aircut
	$(BIN)/python benchmarks/run.py

docs: $(BIN)/aircut
	$(BIN)/python scripts/reference

clean:
	rm -rf $(VENV) build out src/aircut/kernels/*.so src/aircut/kernels/*.c src/*.egg-info
