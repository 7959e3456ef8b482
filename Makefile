# Everything on a fresh machine that has Python (3.11 or later, with venv) and make.
PYTHON ?= python3
VENV := .venv
BIN := $(VENV)/bin
# A processor count for the tests; numba and BLAS stay on one thread each so that workers do not crowd each other.
JOBS ?= auto
export OMP_NUM_THREADS = 1
export OPENBLAS_NUM_THREADS = 1

.PHONY: run test test-slow fuzz lint bench paper proof clean

run: $(VENV)/.core
	mkdir -p out
	$(BIN)/gearpoly simulate data/pairs/ottewill_18_18.toml --csv out/ottewill_18_18.csv --json out/ottewill_18_18.json --plot out/ottewill_18_18.png
	$(BIN)/gearpoly simulate data/pairs/paper_18_25.toml --turns 1 --csv out/paper_18_25.csv --plot out/paper_18_25.png

test: lint
	$(BIN)/pytest -n $(JOBS) -m "not slow"

test-slow: $(VENV)/.test
	$(BIN)/pytest -n $(JOBS) -m slow

# Inputs of each fuzzer; the table of what became of them ends the run (docs/reliability.md).
FUZZ ?= 10000
fuzz: $(VENV)/.test
	GEARPOLY_FUZZ=$(FUZZ) $(BIN)/pytest tests/fuzz

lint: $(VENV)/.test
	$(BIN)/ruff check .
	$(BIN)/ruff format --check .
	$(BIN)/mypy

bench: $(VENV)/.test
	$(BIN)/python -m benchmarks.contact_kernel
	$(BIN)/python -m benchmarks.fast_path
	$(BIN)/python -m benchmarks.loading
	$(BIN)/python -m benchmarks.convergence
	$(BIN)/python -m benchmarks.reading
	$(BIN)/python -m benchmarks.viewing
	$(BIN)/python -m benchmarks.study

paper: $(VENV)/.core
	$(BIN)/python -m gearpoly.studies.paper --out docs

$(VENV)/.core: pyproject.toml
	test -x $(BIN)/python || $(PYTHON) -m venv $(VENV)
	$(BIN)/python -m pip install --quiet --editable .
	touch $@

$(VENV)/.test: pyproject.toml
	test -x $(BIN)/python || $(PYTHON) -m venv $(VENV)
	$(BIN)/python -m pip install --quiet --editable ".[test]"
	touch $@

# The published seed comes from the commit that is put to the proof, so nobody chose it.
SEED ?= $(shell printf '%d' 0x$$(git log -1 --format=%H | cut -c1-7))
proof: $(VENV)/.core
	mkdir -p out
	$(BIN)/gearpoly prove --seed $(SEED) --json out/proof.json
	$(BIN)/python -m gearpoly.prove.page out/proof.json docs/proof.md

clean:
	rm -rf $(VENV) out .pytest_cache .mypy_cache .ruff_cache .hypothesis
