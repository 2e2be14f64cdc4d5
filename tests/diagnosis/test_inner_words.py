"""The words of inner parameters are free: nothing is read out of a name."""

from dataclasses import dataclass

import numpy as np

from matstd.diagnosis.answer import diagnose
from matstd.diagnosis.fit import inner_unit
from matstd.twin.library import parse_effect
from matstd.twin.model import Inner
from matstd.twin.thermal import ThermalLag

HIDDEN = (5, "hsm600u", ("thermal-lag(EXC)",))


@dataclass(frozen=True)
class Settling(ThermalLag):
    """The same lag by another word for its time constant."""

    def inner(self, touches):
        return (super().inner(touches)[0]._replace(name="settling"),)

    def tuned(self, *values):
        return Settling(self.symbol, self.drive, float(values[0]))

    @property
    def tuning(self):
        return {"settling": self.tau}


def test_a_span_of_time_is_reported_in_minutes_whatever_its_name() -> None:
    grid = np.array([60.0, 600.0])
    for name in ("tau", "settling", "x"):
        assert inner_unit(Inner(name, "s", grid)) == ("_min", 60.0)
        assert inner_unit(Inner(name, "s", grid, acts="at an instant")) == ("_s", 1.0)
    assert inner_unit(Inner("tau", "mm", grid)) == ("_mm", 1.0)


def test_the_same_lag_by_another_word_gives_the_same_answer(case) -> None:
    """EXC after switching on, hidden by the simulator: size, time constant, uncertainties alike."""
    run = case(*HIDDEN).run[::6]
    lag = parse_effect("thermal-lag(EXC)", run.touches.chain)
    reported = {}
    for effect in (lag, Settling(lag.symbol, lag.drive)):
        (step,) = diagnose(run, candidates=[effect]).steps[1:]
        reported[type(effect).__name__] = {r.name: (r.value, r.u) for r in step.reported}
    assert reported["Settling"]["settling_min"] == reported["ThermalLag"].pop("tau_min")
    del reported["Settling"]["settling_min"]
    assert reported["Settling"] == reported["ThermalLag"]
