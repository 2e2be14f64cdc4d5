"""Long runs are searched in a choice of their rows first; what is reported stands beyond chance."""

from types import SimpleNamespace

import numpy as np
import pytest

from matstd.diagnosis.answer import Step, Verdict, diagnose
from matstd.diagnosis.answer.steps import weakest
from matstd.diagnosis.choice.noise_memory import CHOSEN_ROWS, chosen_rows
from matstd.diagnosis.fit import Reported, Role
from matstd.twin.frames import Array
from matstd.twin.machine import Axis, make_chain
from matstd.twin.record import Instrument, Run, Setup, Touches
from matstd.twin.record.touches import motion
from matstd.twin.units import UM

AXIS = make_chain("one axis", "[w f X t]", {"X": Axis((0.0, 400.0))})


def log_of(rows: int, error: Array | None = None, seed: int = 0, memory: float = 0.8) -> Run:
    """Rows every half second of an axis that goes to and fro, 0.3 µm of noise that remembers."""
    rng = np.random.default_rng(seed)
    time = 0.5 * np.arange(rows)
    way = (1.7 * time) % 720.0
    x = 20.0 + np.minimum(way, 720.0 - way)
    noise = rng.normal(0.0, 0.3 * UM, rows)
    for i in range(1, rows):
        noise[i] = memory * noise[i - 1] + np.sqrt(1.0 - memory**2) * noise[i]
    touches = Touches(
        chain=AXIS,
        q=x[:, None],
        length=np.zeros(rows),
        radius=np.zeros(rows),
        instrument=Instrument.ENCODER,
        point=np.column_stack([x, np.zeros((rows, 2))]),
        normal=np.tile([1.0, 0.0, 0.0], (rows, 1)),
        setups=(Setup("a"),),
        setup=np.zeros(rows, dtype=np.int64),
        time=time,
        approach=motion(x[:, None], time),
    )
    wave = 0.0 if error is None else error
    return Run(touches, noise - wave, np.full(rows, 0.3 * UM))


def test_a_choice_takes_one_row_of_every_stretch() -> None:
    run = log_of(3 * CHOSEN_ROWS)
    some = chosen_rows(run)
    assert len(some) == CHOSEN_ROWS
    np.testing.assert_array_equal(np.floor(some.touches.time / 1.5), np.arange(CHOSEN_ROWS))
    assert len(np.unique(np.diff(some.touches.time))) > 2  # even steps would alias


@pytest.mark.slow
def test_a_long_log_is_reported_its_wave_and_no_more() -> None:
    """The memory of 0.8 is found beside a wave of thirty times the noise."""
    x = log_of(8000).touches.q[:, 0]
    found = diagnose(log_of(8000, 8.2 * UM * np.sin(2.0 * np.pi * x / 2.5 + 1.1)))
    assert [e.name for e in found.found] == ["periodic(EXX)"]
    assert found.verdict is Verdict.MISSING
    size = next(r for r in found.steps[1].reported if r.role is Role.SIZE)
    assert abs(size.value - 8.2) < 3.0 * size.u < 0.03
    assert found.fit.memory is not None
    assert found.fit.memory.correlation == pytest.approx(0.8, abs=0.03)


def step(name: str, value: float, u: float, p: float, parameters: int = 2) -> Step:
    size = Reported("amplitude", "um", value, u, UM, Role.SIZE)
    effect = SimpleNamespace(name=name, parameters=("",) * parameters)
    return Step(effect=effect, fit=None, p_value=p, reported=(size,), confusion=None)  # type: ignore[arg-type]


def test_what_says_least_falls_first() -> None:
    """By its size over its uncertainty, or because chance explains it."""
    sure, faint, chance = step("a", 9, 1, 1e-9), step("b", 3, 2, 1e-9), step("c", 9, 1, 0.06)
    assert weakest([sure], is_weighed=False) is None
    assert weakest([sure, faint], is_weighed=False) == "b"
    assert weakest([sure, faint, chance], is_weighed=False) == "c"
    form = step("d", 3, 2, 1e-9, parameters=21)  # their length says little where they are there
    assert weakest([sure, form], is_weighed=False) is None


def test_members_of_a_weighed_set_fall_only_if_nothing_speaks_for_them() -> None:
    faint, chance, both = step("a", 3, 2, 1e-9), step("b", 9, 1, 0.06), step("c", 3, 2, 0.06)
    assert weakest([faint, chance], is_weighed=True) is None
    assert weakest([faint, chance, both], is_weighed=True) == "c"
