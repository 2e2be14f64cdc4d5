"""One thread a worker: several workers, each with as many BLAS threads as cores, only wait."""

import gc
import os
import sys
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from functools import cache, partial
from pathlib import Path
from types import ModuleType
from typing import Any

import pytest

for name in ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS"):
    os.environ.setdefault(name, "1")

# a process that a test starts shall not compile every module anew
os.environ.pop("PYTHONDONTWRITEBYTECODE", None)
sys.dont_write_bytecode = False

# 4500 collected tests and the parsed house are looked through for garbage at every 700th object
# otherwise: a third of the time of the collection, a quarter of that of the tests
gc.set_threshold(50_000, 20, 20)

pytest_plugins = [
    "bench",
    "browser",
    "commands",
    "firefox",
    "machines",
    "standards",
    "runs",
    "unchanged",
    "workshop",
]
"""Fixtures that the tests of several rooms share, in `tests/fixtures`."""


LONGEST = (
    "test_door.py",
    "matstd/test_design.py",
    "diagnosis/test_laws.py",
    "report/test_diagnosis_pictures.py",
    "cad_out/test_files_stay.py",
    "diagnosis/test_several_runs.py",
    "diagnosis/test_hidden_effects.py",
    "diagnosis/test_files_and_commands.py",
    "matstd/test_reach.py",
    "matstd/test_seat.py",
    "probe_paths/test_simulate.py",
    "diagnosis/test_other_run.py",
    "matstd/test_measure_commands.py",
    "test_examples_diagnosis.py",
    "diagnosis/test_reported_set.py",
    "test_examples.py",
    "test_examples_runs.py",
    "report/test_scenes.py",
)
"""Files of more than six seconds: begun first, so that no worker waits for one at the end; left
to itself, xdist begins with the files of most tests."""


TOGETHER = (
    # the kernel takes two seconds to load, `built` eight to build
    ("tests/cad_out/", "tests/matstd/test_design.py"),
    (  # `warm`
        "tests/report/test_live_page.py",
        "tests/report/test_diagnosis_pictures.py",
        "tests/diagnosis/test_reduced.py",
        "tests/test_formats.py",
    ),
    (  # `stylus`
        "tests/diagnosis/test_laws.py",
        "tests/diagnosis/test_said_of_laws.py",
        "tests/report/test_live_laws.py",
    ),
    ("tests/test_door.py", "tests/matstd/test_whole_commands.py"),  # `workshop`
)
"""Folders and files that one worker has, because they share what takes seconds to make."""


def pytest_xdist_make_scheduler(config: pytest.Config, log: Any) -> Any:
    """A file is one worker's, and so are those that belong together."""
    from xdist.scheduler import LoadFileScheduling

    class TogetherScheduling(LoadFileScheduling):
        def _split_scope(self, nodeid: str) -> str:
            file: str = super()._split_scope(nodeid)
            return next((group[0] for group in TOGETHER if file.startswith(group)), file)

    return TogetherScheduling(config, log)


def pytest_report_header() -> str:
    """Whether the live pages are driven."""
    from browser import MISSING, is_here

    return "pages are driven in Chromium" if is_here() else MISSING


def pytest_collection_modifyitems(config: pytest.Config, items: list[pytest.Item]) -> None:
    """For several workers the longest files first, the others in their order."""
    if not hasattr(config, "workerinput"):
        return
    rank = {Path(__file__).parent / name: k for k, name in enumerate(LONGEST)}
    assert all(path.exists() for path in rank), "LONGEST names a file that is gone"
    items.sort(key=lambda item: rank.get(item.path, len(rank)))


def pytest_collection_finish() -> None:
    """What is there now stays: garbage is looked for among what comes, at the end five times."""
    gc.freeze()


@pytest.fixture(scope="session", autouse=True)
def _as_in_a_test():
    """What the commands do otherwise, in a test.

    A slow machine prints its progress every ten seconds: nothing a test can count on. The workers
    share the cores: nothing is done in a further process, where what a test has patched would not
    be. Pictures have a fifth of the dots. The Monte Carlo counts in numpy: its loops take numba
    half a minute to compile, and `compiled_loops` brings them back for the tests that compare the
    two. The installed packages are looked through for effects once, not by every command.
    """
    from matstd.sensitivity.montecarlo import lengths
    from matstd.twin.library import catalogue

    with pytest.MonkeyPatch.context() as patch:
        patch.setattr("matstd.progress.PERIOD", 1e6)
        patch.setattr("matstd.twin.beside.CORES", 1)
        patch.setattr("matstd.report.style._DPI", 60)
        patch.setattr(catalogue, "entry_points", cache(catalogue.entry_points))
        compiled_count = lengths.compiled_count
        patch.setattr(lengths, "compiled_count", lambda: None)
        yield compiled_count


@pytest.fixture
def compiled_loops(_as_in_a_test: Callable[[], Any], monkeypatch: pytest.MonkeyPatch) -> None:
    """The loops of the Monte Carlo as numba compiles them."""
    monkeypatch.setattr("matstd.sensitivity.montecarlo.lengths.compiled_count", _as_in_a_test)


@pytest.fixture(scope="session")
def golden() -> ModuleType:
    """The module that makes the golden programs."""
    import make_programs

    return make_programs


@pytest.fixture
def rendered_alone(monkeypatch: pytest.MonkeyPatch) -> Callable[..., None]:
    """A function (first words of names): from now on figures are rendered to these files alone."""
    from figures import render_alone

    return partial(render_alone, monkeypatch)


@pytest.fixture
def unrendered(rendered_alone: Callable[..., None]) -> None:
    """Figures are made, but not rendered: for who reads only the page around them.

    Rendering is most of the time of a page; `report/test_diagnosis_pictures` renders every kind.
    """
    rendered_alone()


@contextmanager
def _library_kept() -> Iterator[None]:
    """Kinds that are registered meanwhile are forgotten: the next may have another machine."""
    from matstd.twin.library import catalogue

    kinds, files = dict(catalogue._REGISTER), dict(catalogue._FILES)
    yield
    for register, before in ((catalogue._REGISTER, kinds), (catalogue._FILES, files)):
        register.clear()
        register.update(before)


@pytest.fixture(scope="session", autouse=True)
def _library_at_first():
    """The library before any test: the files of the session's fixtures register their effects."""
    from matstd.twin.library import catalogue

    return dict(catalogue._REGISTER), dict(catalogue._FILES)


@pytest.fixture(scope="module", autouse=True)
def _library_as_before_the_file(_library_at_first):
    """What the fixtures of a file register, commands that they run for one."""
    from matstd.twin.library import catalogue

    with _library_kept():
        for register, first in zip(
            (catalogue._REGISTER, catalogue._FILES), _library_at_first, strict=True
        ):
            register.clear()
            register.update(first)
        yield


@pytest.fixture(autouse=True)
def _library_as_it_was():
    """What a test registers."""
    with _library_kept():
        yield
