"""A plugin of pytest that records which tests reach the probes of `mutants.py`, and their times.

`mutants.py` loads it with `-p traced_tests`: with TRACED, the folder of what is recorded, for the
run that records; without it the plugin keeps the tests in the order in which they are named.
"""

import builtins
import json
import os
import time
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

import pytest

EVERY = 60.0  # seconds between two records: a run that is broken off leaves most of what it saw


class Recorder:
    """What the tests of one process reach; a shared fixture is kept apart from its first test."""

    def __init__(self, folder: Path) -> None:
        self.folder = folder
        self.seen: dict[str, set[int]] = {}
        self.fixtures: dict[str, set[int]] = {}
        self.seconds: dict[str, float] = {}
        self.fixture_seconds: dict[str, float] = {}
        self.uses: dict[str, list[str]] = {}
        self.failed: set[str] = set()
        self.now: set[int] = set()
        self.spent = 0.0  # in shared fixtures, s
        self.written = time.monotonic()
        setattr(builtins, "_seen", lambda number: self.now.add(number))  # noqa: B010

    @contextmanager
    def into(self, numbers: set[int]) -> Iterator[None]:
        """Probes are reported to these numbers meanwhile."""
        before, self.now = self.now, numbers
        yield
        self.now = before

    @pytest.hookimpl(wrapper=True)
    def pytest_runtest_protocol(self, item: pytest.Function) -> Iterator[None]:
        """One test, without the shared fixtures that it is the first to use."""
        self.uses[item.nodeid] = self.named(item)
        begun, self.spent = time.monotonic(), 0.0
        with self.into(self.seen.setdefault(item.nodeid, set())):
            yield
        self.seconds[item.nodeid] = time.monotonic() - begun - self.spent
        if time.monotonic() > self.written + EVERY:
            self.write()

    def named(self, item: pytest.Function) -> list[str]:
        """Places and names of all fixtures that a test may use."""
        infos = getattr(item, "_fixtureinfo", None)
        found = {} if infos is None else infos.name2fixturedefs
        return [f"{d.baseid}::{name}" for name, defs in found.items() for d in defs]

    @pytest.hookimpl(wrapper=True)
    def pytest_fixture_setup(self, fixturedef: pytest.FixtureDef[object]) -> Iterator[object]:
        """One fixture; that of a single test counts as part of it."""
        if fixturedef.scope == "function":
            return (yield)
        name = f"{fixturedef.baseid}::{fixturedef.argname}"
        begun, before = time.monotonic(), self.spent
        with self.into(self.fixtures.setdefault(name, set())):
            result = yield
        own = time.monotonic() - begun - (self.spent - before)
        self.fixture_seconds[name] = max(own, self.fixture_seconds.get(name, 0.0))
        self.spent += own
        return result

    def pytest_runtest_logreport(self, report: pytest.TestReport) -> None:
        """Tests that fail, which notice nothing."""
        if report.failed:
            self.failed.add(report.nodeid)

    def pytest_sessionfinish(self) -> None:
        """The last record; the process that distributes the tests runs none."""
        if self.seconds:
            self.write()

    def write(self) -> None:
        """Writes what this process recorded until now."""
        self.written = time.monotonic()
        record = {
            "seen": {test: sorted(self.seen[test]) for test in self.seconds},
            "fixtures": {name: sorted(n) for name, n in self.fixtures.items()},
            "seconds": self.seconds,
            "fixture_seconds": self.fixture_seconds,
            "uses": self.uses,
            "failed": sorted(self.failed),
        }
        (self.folder / f"{os.getpid()}.json").write_text(json.dumps(record), encoding="utf-8")


class InOrder:
    """Tests run in the order in which they are named."""

    @pytest.hookimpl(trylast=True)
    def pytest_collection_modifyitems(
        self, config: pytest.Config, items: list[pytest.Item]
    ) -> None:
        """The order of the command line."""
        place = {name: k for k, name in enumerate(config.args)}
        items.sort(key=lambda item: place.get(item.nodeid, len(place)))


def pytest_configure(config: pytest.Config) -> None:
    """Registers what this run needs."""
    folder = os.environ.get("TRACED")
    config.pluginmanager.register(Recorder(Path(folder)) if folder else InOrder(), "traced")
