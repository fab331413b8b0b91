# Two commands on a fresh clone: `make demo` and `make test`. Each sets itself up in .venv.
PYTHON ?= $(shell command -v python3.11 || command -v python3)
BIN := .venv/bin
JOBS ?= $(shell expr $$(getconf _NPROCESSORS_ONLN) + 1)
PYTEST = env -u PYTHONDONTWRITEBYTECODE $(BIN)/python -m pytest -n $(JOBS) --dist loadfile --no-loadscope-reorder
export PIP_DISABLE_PIP_VERSION_CHECK = 1

.PHONY: setup demo test test-all lint types check docs tutorial pictures bench chea-tables chea-niching chea-table7 identification-tables blind recorder tracking soak fuzz clean

demo: .venv/ready
	$(BIN)/rotor demo --out demo --force

# Both on every core and one job more, as many tests wait for programs they have started; a file of tests at a time, so
# that what a file has set up is made once. The programs find their modules compiled, whatever the shell says of bytecode.
test: .venv/ready
	$(PYTEST) -m "not campaign"

# What takes minutes: whole campaigns, every drive's contract, the documents' long commands, blind cases, the tests of
# the benchmarks.
test-all: .venv/ready
	$(PYTEST) -m campaign

lint: .venv/ready
	$(BIN)/ruff check .
	$(BIN)/ruff format --check .

types: .venv/ready
	$(BIN)/mypy

check: lint types test test-all

setup: .venv/ready

# Generated pages, and the pictures that are drawn in seconds: the tests make them again and compare.
docs: .venv/ready
	OPENBLAS_NUM_THREADS=1 $(BIN)/python -m docs.make_docs

# The tutorial's commands, run for real; its outputs, times and pictures are written into it.
tutorial: .venv/ready
	OPENBLAS_NUM_THREADS=1 $(BIN)/python -m docs.make_tutorial

# All pictures. Minutes; wants Chromium, a Vulkan driver and what `make demo` wrote.
pictures: docs tutorial
	OPENBLAS_NUM_THREADS=1 $(BIN)/python -m docs.make_measured_run_up
	OPENBLAS_NUM_THREADS=1 $(BIN)/python -m docs.make_chea_table7
	OPENBLAS_NUM_THREADS=1 $(BIN)/python -m docs.make_chapter
	OPENBLAS_NUM_THREADS=1 $(BIN)/python -m docs.make_discovery
	$(BIN)/python -m docs.make_pictures demo

bench: .venv/ready .venv-ross/ready
	$(BIN)/python benchmarks/forward.py --write

# Long: the optimiser beside its peers, and the chapter's identification tables. One BLAS thread: the matrices are small.
chea-tables: .venv/ready
	OPENBLAS_NUM_THREADS=1 $(BIN)/python benchmarks/chea_tables.py --seeds 100 --peer-seeds 100 --dimensions --write

# How many global minima are listed when all are asked for: hours; Ctrl-C and the same command go on.
chea-niching: .venv/ready
	OPENBLAS_NUM_THREADS=1 $(BIN)/python benchmarks/chea_niching.py --seeds 20 --write

# The chapter's Table 7 by the chapter's algorithm: some twenty minutes of one core; Ctrl-C and the same command go on.
chea-table7: .venv/ready
	OPENBLAS_NUM_THREADS=1 $(BIN)/python benchmarks/chea_table7.py --seeds 200 --truths 100 --staged 6 --write
	OPENBLAS_NUM_THREADS=1 $(BIN)/python -m docs.make_chea_table7
	OPENBLAS_NUM_THREADS=1 $(BIN)/python -m docs.make_docs

identification-tables: .venv/ready
	OPENBLAS_NUM_THREADS=1 $(BIN)/python benchmarks/identification.py --write

# Ten hours on two cores: hidden faults, and how often they are found. Cases are kept in the repository; Ctrl-C and the
# same command go on. It runs one version of the code, on seeds that nobody has run: for one that is done.
blind: .venv/ready
	OPENBLAS_NUM_THREADS=1 $(BIN)/python benchmarks/blind.py --examine --write

# Twenty minutes: a recording at full rate, how soon a trip reaches the drive, kill -9.
recorder: .venv/ready
	OPENBLAS_NUM_THREADS=1 $(BIN)/python benchmarks/recorder.py --write

# Five minutes: how exact and how quick the tracking is, beside others, and how late the live view.
tracking: .venv/ready
	$(BIN)/python benchmarks/tracking.py --write

# Hours: single faults on every motor controller and all pairs of faults on three, against peers that share no code with
# rotorrig, judged from outside. Results are kept in the repository; Ctrl-C and the same command go on.
soak: .venv/ready
	OPENBLAS_NUM_THREADS=1 $(BIN)/python benchmarks/soak.py --singles --pairs --page

# A quarter of an hour on two cores: damaged files of every kind through every reader. Findings, and how far it came, are
# kept in fuzz-findings; Ctrl-C and the same command go on. Another campaign: make fuzz FUZZ="--seed 2".
fuzz: .venv/ready
	OPENBLAS_NUM_THREADS=1 $(BIN)/python -m tests.fuzz --inputs 100000 $(FUZZ)

# uv where there is one (seconds), else the venv module and pip; the same pinned versions either way. Made anew when the
# versions change: an old one may be of another Python.
.venv/ready: pyproject.toml constraints.txt
	@if command -v uv >/dev/null 2>&1; then \
	    echo "setting up .venv with uv"; \
	    uv venv --quiet --clear --python "$(PYTHON)" .venv && \
	    UV_BUILD_CONSTRAINT=constraints.txt uv pip install --quiet --compile-bytecode --python .venv/bin/python -c constraints.txt -e '.[dev]'; \
	else \
	    echo "setting up .venv with pip (about a minute)"; \
	    "$(PYTHON)" -m venv --clear .venv && \
	    PIP_CONSTRAINT=constraints.txt $(BIN)/python -m pip install --quiet -e '.[dev]'; \
	fi
	@touch $@

# ROSS, the peer of the benchmarks, needs older packages than ours: an environment of its own.
.venv-ross/ready: constraints-ross.txt
	@if command -v uv >/dev/null 2>&1; then \
	    uv venv --quiet --clear --python "$(PYTHON)" .venv-ross && \
	    uv pip install --quiet --python .venv-ross/bin/python -c constraints-ross.txt ross-rotordynamics; \
	else \
	    echo "setting up .venv-ross with pip (a few minutes)"; \
	    "$(PYTHON)" -m venv --clear .venv-ross && \
	    .venv-ross/bin/python -m pip install --quiet -c constraints-ross.txt ross-rotordynamics; \
	fi
	@touch $@

clean:
	rm -rf .venv .venv-ross demo .pytest_cache .ruff_cache .mypy_cache .hypothesis
