"""A plugin of pytest that records which test files execute which lines, and how long each takes.

`mutants.py` loads it: with `-p traced_tests`, and TRACED as the folder of what it records.
"""

import json
import os
import time
from collections import Counter
from collections.abc import Iterator
from pathlib import Path

import coverage
import pytest

FOLDER = Path(os.environ["TRACED"])


class Tracer:
    """Coverage of one process, with the test file as its context."""

    def __init__(self, root: Path) -> None:
        self.seconds: Counter[str] = Counter()
        self.coverage = coverage.Coverage(
            data_file=str(FOLDER / "lines"),
            data_suffix=True,
            config_file=False,
            include=[f"{root}/*"],
            omit=[f"{root}/{name}/*" for name in (".venv", "tests", "benchmarks", "examples")],
        )
        self.coverage.start()

    @pytest.hookimpl(wrapper=True)
    def pytest_runtest_protocol(self, item: pytest.Item) -> Iterator[None]:
        file = item.path.relative_to(item.config.rootpath).as_posix()
        self.coverage.switch_context(file)
        begun = time.monotonic()
        yield
        self.seconds[file] += time.monotonic() - begun

    def pytest_sessionfinish(self) -> None:
        self.coverage.stop()
        if not self.seconds:  # the process that distributes the tests runs none itself
            return
        self.coverage.save()
        (FOLDER / f"seconds-{os.getpid()}.json").write_text(json.dumps(self.seconds))


def pytest_configure(config: pytest.Config) -> None:
    config.pluginmanager.register(Tracer(config.rootpath), "traced")
