"""The small standard, its plan and its programs, as the golden files have them."""

from pathlib import Path

import pytest

from matstd.probe_paths.campaign import VirtualMachine
from matstd.probe_paths.control import ReadProgram, interpret
from matstd.probe_paths.emit import ProgramSet
from matstd.probe_paths.plan import TouchPlan

GOLDEN = Path(__file__).parents[1] / "golden"


@pytest.fixture(scope="session")
def golden_folder() -> Path:
    return GOLDEN / "programs"


@pytest.fixture(scope="session")
def chain(golden):
    return golden.machine()


@pytest.fixture(scope="session")
def small(golden):
    return golden.standard()


@pytest.fixture(scope="session")
def plan(golden) -> TouchPlan:
    return golden.plan()


@pytest.fixture(scope="session")
def programs(golden) -> ProgramSet:
    return golden.programs()


@pytest.fixture(scope="session")
def read(programs, chain) -> list[ReadProgram]:
    """Every golden program, read from its text."""
    return [
        interpret(p.text.encode("ascii"), Path(f"{p.name}.H"), programs.masks.get, chain)
        for p in programs.programs
    ]


@pytest.fixture(scope="session")
def perfect(chain) -> VirtualMachine:
    """A machine without errors and noise."""
    return VirtualMachine(chain)
