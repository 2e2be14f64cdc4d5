"""The small standard, its plan and its programs, as the golden files have them."""

import shutil
from pathlib import Path

import pytest
from programs import all_read

from matstd.artefact.body import write_standard
from matstd.probe_paths.campaign import VirtualMachine
from matstd.probe_paths.control import ReadProgram
from matstd.probe_paths.emit import ProgramSet
from matstd.probe_paths.plan import TouchPlan

GOLDEN = Path(__file__).parents[1] / "golden"
MACHINE = Path(__file__).parents[2] / "examples" / "hsm600u-machine.toml"


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
    return all_read(programs, chain)


@pytest.fixture(scope="session")
def for_linuxcnc(golden) -> ProgramSet:
    return golden.programs("linuxcnc")


@pytest.fixture(scope="session")
def twins(for_linuxcnc, chain) -> list[ReadProgram]:
    """Every golden program for LinuxCNC, read from its text."""
    return all_read(for_linuxcnc, chain)


@pytest.fixture(scope="session")
def design(golden, tmp_path_factory) -> Path:
    """A folder as a design leaves it, of the small standard; the example's machine is its own."""
    folder = tmp_path_factory.mktemp("design")
    write_standard(folder / "standard.toml", golden.standard())
    shutil.copyfile(MACHINE, folder / "machine.toml")
    golden.programs().write(folder / "programs")
    return folder


@pytest.fixture(scope="session")
def perfect(chain) -> VirtualMachine:
    """A machine without errors and noise."""
    return VirtualMachine(chain)
