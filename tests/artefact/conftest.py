"""The demo standard, built once for the tests of the room."""

import runpy
from pathlib import Path

import pytest

demo = runpy.run_path(str(Path(__file__).with_name("demo.py")))


@pytest.fixture(scope="session")
def standard():
    return demo["demo_standard"]()


@pytest.fixture(scope="session")
def demo_sites():
    return demo["demo_sites"]()
