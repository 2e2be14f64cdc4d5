"""Hidden effects of the simulator, each by its own formula.

An effect is a function of the state of all touches that returns what it adds: component errors by
name (mm, rad), a shift of the standard, a growth of the standard, a bias of the trigger; the form
error of a pad is built into the true surface instead.
"""

from collections.abc import Callable
from dataclasses import dataclass, field

import numpy as np
from simulator_machine import tool_axes


@dataclass
class Hidden:
    """One effect that a case hides.

    `amplitude` in um, urad, um/(m K) or um/h; `act(state, amplitude)` returns a dictionary of what
    it adds: ISO names, "shift" (N, 3), "growth" (N,), "bias" (N,), "form" (pad, wave).
    """

    name: str
    kind: str
    act: Callable
    inner: dict = field(default_factory=dict)
    amplitude: float = 0.0
    largest: float = 250.0


@dataclass
class State:
    """Everything that is known of N touches, as far as it can act on anything."""

    machine: object
    q: dict
    last_move: dict
    time: np.ndarray
    temperature: dict
    rpm: np.ndarray
    setup: np.ndarray
    pad: np.ndarray
    point: np.ndarray  # table frame
    normal: np.ndarray  # table frame

    def __len__(self):
        return len(self.time)

    def fraction(self):
        return np.arange(len(self)) / len(self)

    def latitude_and_azimuth(self):
        inward = np.swapaxes(tool_axes(self.machine, self.q), 1, 2)
        m = (inward @ self.normal[:, :, None])[:, :, 0]
        return np.arccos(np.clip(m[:, 2], -1.0, 1.0)), np.arctan2(m[:, 1], m[:, 0])


SMALL = 1.0e-3
"""One um in mm, and one mm/m in 1: what an amplitude of 1 is in a translation."""


def unit_of(name):
    """What an amplitude of 1 is, in mm or rad, for a component error of that name."""
    return 1.0e-6 if name[1] in "ABC" else SMALL


def coupling(component, other):
    own = component[2:]

    def act(s, a):
        def factor(axis):
            body = s.machine.axis(axis)
            return np.cos(s.q[axis]) if body.rotary else body.u(s.q[axis])

        return {component: a * unit_of(component) * factor(own) * factor(other)}

    inner = {"axis": own, "component": component, "other": other}
    return Hidden(f"coupling({component},{other})", "coupling", act, inner)


def backlash(axis):
    component = f"E{axis[0]}{axis}"

    def act(s, a):
        return {component: 0.5 * a * unit_of(component) * s.last_move[axis]}

    inner = {"axis": axis, "component": component}
    return Hidden(f"backlash({axis})", "backlash", act, inner, largest=100.0)


def periodic(component, period, phase):
    axis = component[2:]

    def act(s, a):
        wave = np.sin(2.0 * np.pi * s.q[axis] / period + phase)
        return {component: a * unit_of(component) * wave}

    inner = {"axis": axis, "component": component, "period_mm": period}
    return Hidden(f"periodic({component})", "periodic", act, inner, largest=40.0)


def harmonic(component, k, phase):
    axis = component[2:]

    def act(s, a):
        return {component: a * unit_of(component) * np.sin(k * s.q[axis] + phase)}

    inner = {"axis": axis, "component": component, "harmonic": k}
    return Hidden(f"periodic({component})", "periodic", act, inner)


def scale_growth(axis, sensor):
    component = f"E{axis[0]}{axis}"

    def act(s, a):
        return {component: a * 1.0e-6 * (s.temperature[sensor] - 20.0) * s.q[axis]}

    inner = {"axis": axis, "component": component}
    name = f"thermal-expansion({axis},{sensor})"
    return Hidden(name, "thermal-expansion", act, inner, largest=40.0)


def warm_up(component, minutes):
    def act(s, a):
        done = 1.0 - np.exp(-s.time / (60.0 * minutes))
        return {component: a * unit_of(component) * done}

    inner = {"axis": component[2:], "component": component, "tau_min": minutes}
    return Hidden(f"thermal-lag({component})", "thermal-lag", act, inner)


def after_speed(component, minutes):
    """Heat of the spindle: a step at a time, one touch after the other, from cold."""

    def act(s, a):
        warmth, out, before = 0.0, np.zeros(len(s)), 0.0
        for i in range(len(s)):
            kept = np.exp(-(s.time[i] - before) / (60.0 * minutes))
            warmth = kept * warmth + (1.0 - kept) * s.rpm[max(i - 1, 0)] / 10000.0
            out[i], before = warmth, s.time[i]
        return {component: a * unit_of(component) * out}

    inner = {"axis": component[2:], "component": component, "tau_min": minutes}
    return Hidden(f"thermal-lag({component},spindle_rpm)", "thermal-lag-driven", act, inner)


def after_sensor(component, sensor, minutes):
    """A body that follows a sensor, in balance with it at first: small steps in between."""

    def act(s, a):
        t, warm = s.time, s.temperature[sensor] - 20.0
        level, out, steps = warm[0], np.zeros(len(s)), 50
        out[0] = level
        for i in range(1, len(s)):
            for k in range(steps):
                drive = warm[i - 1] + (warm[i] - warm[i - 1]) * (k + 0.5) / steps
                level += (drive - level) * (t[i] - t[i - 1]) / steps / (60.0 * minutes)
            out[i] = level
        return {component: a * unit_of(component) * out}

    inner = {"axis": component[2:], "component": component, "tau_min": minutes}
    return Hidden(f"thermal-lag({component},{sensor})", "thermal-lag", act, inner)


def sagging_ram(component):
    """A ram under its own weight, the more the further it is out (towards smaller readings)."""
    axis = component[2:]

    def act(s, a):
        body = s.machine.axis(axis)
        out = (body.high - s.q[axis]) / (body.high - body.low)
        return {component: a * unit_of(component) * out**3}

    inner = {"axis": axis, "component": component}
    return Hidden(f"gravity({component})", "gravity", act, inner)


def load_off_centre(component, table, phase):
    def act(s, a):
        moment = np.sin(s.q[component[2:]]) * np.cos(s.q[table] - phase)
        return {component: a * unit_of(component) * moment}

    inner = {"axis": component[2:], "component": component}
    return Hidden(f"gravity({component},{table})", "gravity", act, inner)


def quartic(component):
    """A component error that swings twice over the travel: 8 u^4 - 8 u^2 + 1."""
    axis = component[2:]

    def act(s, a):
        u = s.machine.axis(axis).u(s.q[axis])
        return {component: a * unit_of(component) * (8.0 * u**4 - 8.0 * u**2 + 1.0)}

    inner = {"axis": axis, "component": component}
    return Hidden(f"geometric({component},4)", "geometric", act, inner)


def tilting_weight(axis):
    component = f"E{axis[0]}{axis}"

    def act(s, a):
        return {component: a * 1.0e-6 * 2.0 * np.sin(s.q[axis]) * np.cos(s.q[axis])}

    inner = {"axis": axis, "component": component}
    return Hidden(f"gravity({component})", "gravity", act, inner)


def growth_of_standard(sensor):
    def act(s, a):
        return {"growth": a * 1.0e-6 * (s.temperature[sensor] - 20.0)}

    return Hidden(f"artefact-expansion({sensor})", "artefact-expansion", act, largest=60.0)


def slip(at, direction):
    """The standard moves once; every later touch finds it elsewhere."""

    def act(s, a):
        return {"shift": np.where(s.fraction() >= at, 1.0, 0.0)[:, None] * a * SMALL * direction}

    return Hidden("artefact-slip", "artefact-slip", act, {"at_s": at})


def drift(direction):
    def act(s, a):
        return {"shift": (s.time / 3600.0)[:, None] * a * SMALL * direction}

    return Hidden("drift", "drift", act)


def lobes(k, phase):
    def act(s, a):
        latitude, azimuth = s.latitude_and_azimuth()
        return {"bias": a * SMALL * np.sin(latitude) * np.cos(k * azimuth - phase)}

    return Hidden("probe-lobing", "probe-lobing", act, {"lobes": k}, largest=20.0)


def ball_too_large():
    def act(s, a):
        return {"bias": np.full(len(s), a * SMALL)}

    return Hidden("probe-radius", "probe-radius", act, largest=30.0)


def bending_stylus():
    def act(s, a):
        latitude, _ = s.latitude_and_azimuth()
        return {"bias": a * SMALL * np.sin(latitude) ** 2}

    return Hidden("stylus-bending", "stylus-bending", act, largest=20.0)


def form_of_pad(pad, wave):
    def act(s, a):
        return {"form": (pad, np.concatenate([[a * SMALL], wave[1:]]))}

    name = f"artefact-form(pad{pad})"
    return Hidden(name, "artefact-form", act, {"patch": f"pad{pad}"}, largest=20.0)


def cable(x, width, y):
    """A hose that pushes the ram up where X is near x and Y beyond y."""

    def act(s, a):
        push = np.exp(-(((s.q["X"] - x) / width) ** 2)) * (s.q["Y"] > y)
        return {"EZZ": a * SMALL * push}

    return Hidden("?cable", "unknown", act, {"depends_on": ["X", "Y"]})


def pump(period, phase):
    """A pump that runs half of the time and lifts the head while it does."""

    def act(s, a):
        return {"EZZ": a * SMALL * np.sign(np.sin(2.0 * np.pi * s.time / period + phase))}

    return Hidden("?pump", "unknown", act, {"depends_on": ["time_s"]})


def chiller(period, phase):
    """A cooler that switches at two limits: a saw-tooth in X."""

    def act(s, a):
        tooth = 2.0 * np.mod(s.time / period + phase, 1.0) - 1.0
        return {"EXX": a * SMALL * tooth}

    return Hidden("?chiller", "unknown", act, {"depends_on": ["time_s"]})
