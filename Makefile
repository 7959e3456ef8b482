# Everything on a fresh machine that has Python (3.11 or later, with venv) and make.
PYTHON ?= python3
VENV := .venv
BIN := $(VENV)/bin
# A processor count for the tests; numba and BLAS stay on one thread each so that workers do not crowd each other.
JOBS ?= auto
export OMP_NUM_THREADS = 1
export OPENBLAS_NUM_THREADS = 1
# What Python compiles is kept for the next process, even where the surroundings say no: modules are compiled where they
# are first needed, which takes half as long as compiling all of them when they are installed.
export PYTHONDONTWRITEBYTECODE =

.PHONY: run test test-long test-slow knowledge noise fuzz lint docs bench paper proof clean

# What `make run` shows: the pair of a published experiment, and recordings of an eccentric gear with a low tooth.
PAIR := data/pairs/ottewill_18_18.toml
RECORDED := data/recordings/eccentric_low_tooth

run: $(VENV)/.core
	@mkdir -p out
	@printf '\n1. Simulate a real pair.\n\n'
	$(BIN)/gearpoly simulate $(PAIR) --csv out/simulated.csv --plot out/simulated.png
	@printf '\n2. Compare a recording with the simulation of its pair.\n\n'
	$(BIN)/gearpoly compare $(RECORDED)/pair.toml $(RECORDED)/rec_0.csv --plot out/compared.png
	@printf '\n3. Diagnose what the simulation left out, from both flanks.\n\n'
	$(BIN)/gearpoly diagnose $(RECORDED)/pair.toml $(RECORDED)/rec_*.csv --html out/diagnosis.html --json out/diagnosis.json --fitted out/fitted.toml
	@printf '\n4. In short.\n\n'
	@$(BIN)/python examples/first_run.py out/diagnosis.json out/diagnosis.html out/compared.png out/simulated.png
	@printf 'What was hidden: $(RECORDED).truth.json\n'
	@printf 'Commands of the documentation run as they stand after this line:\n  . $(BIN)/activate\n'

# A file stays with one worker, so that what its tests share is made once. The twenty slowest are listed at the end.
# Types are checked beside what is compiled once for all tests, the tests themselves among it, and beside their ends,
# which leave a processor idle; what is said of them comes last.
test: $(VENV)/.test
	$(BIN)/ruff check .
	$(BIN)/ruff format --check .
	@mkdir -p out
	@$(BIN)/mypy >out/types.txt 2>&1 & types=$$!; \
	$(BIN)/pytest --collect-only --quiet --no-header >out/tests.txt & collected=$$!; \
	$(BIN)/python -m tests.ready; wait $$collected; \
	$(BIN)/pytest -n $(JOBS) --dist loadfile --no-loadscope-reorder --durations=20 -m "not long and not slow"; tests=$$?; \
	wait $$types; typed=$$?; cat out/types.txt; exit $$((tests | typed))

# Every test but those of minutes: those of `make test`, and those that take more than half a second each.
test-long: $(VENV)/.test
	$(BIN)/python -m tests.ready
	$(BIN)/pytest -n $(JOBS) --dist loadfile --no-loadscope-reorder --durations=20 -m "not slow"

test-slow: $(VENV)/.test
	$(BIN)/pytest -n $(JOBS) -m slow

# What the rules of the diagnosis know, held against whole verdicts (docs/reference/rules.md).
knowledge: $(VENV)/.test
	$(BIN)/pytest -n $(JOBS) tests/knowledge tests/knowledge_compare

# Pure noise beside pair files of all kinds: no physics may be named in any.
noise: $(VENV)/.test
	GEARPOLY_NOISE=200 $(BIN)/pytest -n $(JOBS) tests/knowledge/test_pure_noise.py

# Inputs of each fuzzer; the table of what became of them ends the run (docs/explanation/reliability.md).
FUZZ ?= 550
fuzz: $(VENV)/.test
	GEARPOLY_FUZZ=$(FUZZ) $(BIN)/pytest tests/fuzz

lint: $(VENV)/.test
	$(BIN)/ruff check .
	$(BIN)/ruff format --check .
	$(BIN)/mypy

# The site, to open from disk: search works without a network.
docs: $(VENV)/.docs
	$(BIN)/sphinx-build --quiet --fail-on-warning --keep-going --builder html docs out/site
	@printf 'Open out/site/index.html\n'

bench: $(VENV)/.test
	$(BIN)/python -m benchmarks.contact_kernel
	$(BIN)/python -m benchmarks.fast_path
	$(BIN)/python -m benchmarks.loading
	$(BIN)/python -m benchmarks.columns
	$(BIN)/python -m benchmarks.convergence
	$(BIN)/python -m benchmarks.reading
	$(BIN)/python -m benchmarks.viewing
	$(BIN)/python -m benchmarks.study
	$(BIN)/python -m benchmarks.uneven

paper: $(VENV)/.core
	$(BIN)/python -m gearpoly.studies.paper --out docs/explanation

$(VENV)/.core: pyproject.toml
	test -x $(BIN)/python || $(PYTHON) -m venv $(VENV)
	$(BIN)/python -m pip install --quiet --no-compile --editable ".[all]"
	touch $@

$(VENV)/.test: pyproject.toml
	test -x $(BIN)/python || $(PYTHON) -m venv $(VENV)
	$(BIN)/python -m pip install --quiet --no-compile --editable ".[test]"
	touch $@

$(VENV)/.docs: pyproject.toml
	test -x $(BIN)/python || $(PYTHON) -m venv $(VENV)
	$(BIN)/python -m pip install --quiet --no-compile --editable ".[docs]"
	touch $@

# The published seed comes from the commit that is put to the proof, so nobody chose it.
# BESIDE: scoreboards of further finished runs, laid beside it on the page.
SEED ?= $(shell printf '%d' 0x$$(git log -1 --format=%H | cut -c1-7))
proof: $(VENV)/.core
	mkdir -p out
	$(BIN)/gearpoly prove --seed $(SEED) --json out/proof.json
	$(BIN)/python -m gearpoly.prove.page out/proof.json $(BESIDE) docs/proof.md

clean:
	rm -rf $(VENV) out .pytest_cache .mypy_cache .ruff_cache .hypothesis
