# All set-up on a fresh machine with Python 3.11 or later, git and make:
#   make design   the main job, into out/hsm600u
#   make test     the tests
#   make mutants  whether the tests notice 200 wrong lines, two hours
#   make api      the pages of the Python interface, docs/api.md and out/api
PYTHON ?= python3
BIN := .venv/bin
ifeq ($(OS),Windows_NT)
BIN := .venv/Scripts
PYTHON = py -3
endif

.PHONY: design test proof lint benchmark mutants api clean

.venv/installed: pyproject.toml constraints.txt
	$(PYTHON) -m venv .venv
	$(BIN)/python -m pip install --quiet --disable-pip-version-check -c constraints.txt -e ".[test]"
	$(BIN)/python -c "open('.venv/installed', 'w').close()"

design: .venv/installed
	$(BIN)/matstd design examples/hsm600u.toml -o out/hsm600u --force

test: .venv/installed
	$(BIN)/python -m pytest

proof: .venv/installed
	$(BIN)/python -m pytest -m slow

lint: .venv/installed
	$(BIN)/ruff check .
	$(BIN)/ruff format --check .
	$(BIN)/python tests/check_types.py

benchmark: .venv/installed
	$(BIN)/python -m benchmarks

mutants: .venv/installed
	$(BIN)/python -m pip install --quiet --disable-pip-version-check -c constraints.txt -e ".[mutants]"
	$(BIN)/python benchmarks/mutants.py

api: .venv/installed
	$(BIN)/python -m pip install --quiet --disable-pip-version-check -c constraints.txt -e ".[docs]"
	$(BIN)/python docs/make_api.py

clean:
	$(PYTHON) -c "import shutil; [shutil.rmtree(d, ignore_errors=True) for d in ('.venv', 'build', 'out')]"
