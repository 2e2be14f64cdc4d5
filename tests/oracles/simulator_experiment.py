"""What the simulator probes with: machines, errors, standards, set-ups, plans, temperatures."""

from dataclasses import dataclass

import numpy as np
from simulator_effects import State
from simulator_machine import read_machine, readings_at
from simulator_surface import HALF, random_pads, surface_point

MACHINES = {
    "hsm600u": """format = "machine/1"
name = "hsm600u"
chain = "[w C' B' X' f Y Z (C1) t]"

[axis.X]
range = [-400.0, 400.0]
[axis.Y]
range = [-300.0, 300.0]
[axis.Z]
range = [-500.0, 0.0]
[axis.B]
range = [-110.0, 30.0]
point = [0.0, 0.0, -420.0]
[axis.C]
range = [-360.0, 360.0]
point = [0.0, 0.0, 0.0]

[workpiece]
origin = [0.0, 0.0, -500.0]
""",
    "fork": """format = "machine/1"
name = "fork"
chain = "[w C' X' f Y Z B (C1) t]"

[axis.X]
range = [-600.0, 600.0]
[axis.Y]
range = [-500.0, 500.0]
[axis.Z]
range = [-700.0, 0.0]
[axis.B]
range = [-110.0, 110.0]
point = [0.0, 0.0, 220.0]
[axis.C]
range = [-360.0, 360.0]
point = [0.0, 0.0, 0.0]

[workpiece]
origin = [0.0, 0.0, -700.0]
""",
    "hmc1995": """format = "machine/1"
name = "hmc1995"
chain = "[w X' Z' f Y (C1) t]"

[axis.X]
range = [-375.0, 375.0]
[axis.Y]
range = [-250.0, 250.0]
[axis.Z]
range = [-600.0, 0.0]

[workpiece]
origin = [0.0, -150.0, -560.0]
""",
}
"""Machine files as in the reference cases."""

TILTS = {"hsm600u": (-95.0, 28.0), "fork": (-80.0, 80.0)}
"""Range of the tilting axis that is used, deg."""

RADIUS, LENGTH = 3.0, 160.0
STATED_NOISE = 0.6e-3
TOUCHES_A_POSE = 26
DURATION = 10800.0
SHALLOWEST = -0.15
"""Least component of the normal along the tool axis at which a probe still triggers."""


@dataclass
class Experiment:
    """A machine with its errors, a standard with its set-ups, and the plan of a run."""

    machine: object
    label: str
    pads: object
    stated: list  # (origin (3,), rotation about z)
    actual: list  # (4, 4) matrices
    errors: dict  # ISO name -> function of the readings
    q: dict
    setup: np.ndarray
    pose: np.ndarray
    pad: np.ndarray
    place: tuple
    last_turn: dict
    time: np.ndarray
    temperature: dict
    rpm: np.ndarray


def pose_about_z(origin, angle):
    c, s = np.cos(angle), np.sin(angle)
    return np.array(
        [[c, -s, 0, origin[0]], [s, c, 0, origin[1]], [0, 0, 1, origin[2]], [0, 0, 0, 1]]
    )


def random_errors(rng, machine):
    """Six component errors of every axis and all its location errors, as functions of readings."""
    errors = {}
    for axis in machine.axes:
        for letter in "XYZABC":
            unit, low, high = (1e-3, 2.0, 10.0) if letter in "XYZ" else (1e-6, 5.0, 25.0)
            size = rng.uniform(low, high) * unit * rng.choice([-1.0, 1.0])
            errors[f"E{letter}{axis.name}"] = component_function(rng, axis, size)
            if axis.programmed:
                spread = 10.0e-3 if letter in "XYZ" else 20.0e-6
                errors[f"E{letter}0{axis.name}"] = constant(rng.normal(0.0, spread))
    return errors


def constant(value):
    return lambda q: np.full(len(next(iter(q.values()))), value)


def component_function(rng, axis, size):
    """Linear, parabolic or one sine over the travel; harmonic 1 of a rotary axis."""
    phase, shape = rng.uniform(0.0, 2.0 * np.pi), rng.integers(3)
    if not axis.programmed:
        return constant(size)
    if axis.rotary:
        return lambda q: size * np.sin(q[axis.name] + phase)
    if shape == 0:
        return lambda q: size * axis.u(q[axis.name])
    if shape == 1:
        return lambda q: size * (2.0 * axis.u(q[axis.name]) ** 2 - 1.0)
    return lambda q: size * np.sin(np.pi * (axis.u(q[axis.name]) + 1.0) + phase)


def random_setups(rng, label):
    """Stated set-ups, the first one straight; and where the standard really stands."""
    stated = [(np.zeros(3), 0.0)]
    spread, lift, count = (170.0, 150.0, 5) if label == "hmc1995" else (115.0, 40.0, 3)
    for _ in range(count - 1):
        place = np.array([*rng.uniform(-spread, spread, 2), rng.uniform(0.0, lift)])
        stated.append((np.round(place, 6), float(np.radians(np.round(rng.uniform(0, 360), 6)))))
    return stated, placed(rng, stated)


def placed(rng, stated):
    """Where a standard really stands that was put on the table by hand, (4, 4) each."""
    actual = []
    for origin, angle in stated:
        a, b, c = rng.normal(0.0, 20.0e-6, 3)
        small = np.array([[1, -c, b, 0], [c, 1, -a, 0], [-b, a, 1, 0], [0, 0, 0, 1.0]])
        small[:3, 3] = rng.normal(0.0, 10.0e-3, 3)
        u, _, vt = np.linalg.svd(small[:3, :3])
        small[:3, :3] = u @ vt
        actual.append(pose_about_z(origin, angle) @ small)
    return actual


def random_poses(rng, label, setups, each=10):
    """(set-up, tilt, turn) in rad of every table pose, in time order, so many each set-up."""
    poses = []
    for s in range(setups):
        if label == "hmc1995":
            poses += [(s, 0.0, 0.0)] * (each * 6 // 10)
            continue
        poses.append((s, 0.0, 0.0))
        for i in range(1, each):
            tilt = rng.uniform(*TILTS[label])
            turned = min(360.0 / each * i + rng.uniform(-6.0, 6.0) * 3.0, 360.0)
            poses.append((s, np.radians(np.round(tilt, 7)), np.radians(np.round(turned, 7))))
    return poses


def plan_pose(rng, machine, pads, stated, tilt, turned):
    """Touches of one pose that the probe can reach within all travels; None if too few."""
    tries = 120
    pad = rng.integers(len(pads), size=tries)
    x, y = rng.uniform(-HALF, HALF, (2, tries))
    point, normal = surface_point(pads, pad, x, y)
    T = pose_about_z(*stated)
    target = point @ T[:3, :3].T + T[:3, 3] + RADIUS * (normal @ T[:3, :3].T)
    rest = {name: np.zeros(tries) for name in machine.linear}
    for name, value in zip(sorted(machine.rotary), (tilt, turned), strict=False):
        rest[name] = np.full(tries, value)  # B before C
    q = readings_at(machine, target, rest, LENGTH)
    usable = np.ones(tries, dtype=bool)
    for name in machine.linear:
        axis = machine.axis(name)
        usable &= (q[name] > axis.low) & (q[name] < axis.high)
    state = State(machine, q, {}, np.zeros(tries), {}, None, None, pad, point, normal @ T[:3, :3].T)
    latitude, _ = state.latitude_and_azimuth()
    usable &= np.cos(latitude) > SHALLOWEST
    rows = np.flatnonzero(usable)[:TOUCHES_A_POSE]
    if len(rows) < TOUCHES_A_POSE:
        return None
    return {k: v[rows] for k, v in q.items()}, pad[rows], (x[rows], y[rows])


def from_cold(t):
    """Share of a body's rise at times t, from a cold start on, by its time constant."""
    return lambda tau: 1 - np.exp(-t / tau)


def temperatures(rng, t, risen=None):
    """Six sensors: the room, three scales, the spindle, the standard.

    Args:
        rng: Source of the phases of the weather.
        t: Time from the first touch on, s.
        risen: Share of a body's rise by its time constant; None for a cold start.
    """
    risen = risen or from_cold(t)
    phase = rng.uniform(0.0, 2.0 * np.pi, 4)
    ambient = 20.0 + 1.2 * np.sin(2 * np.pi * t / 18000.0 + phase[0]) + 3.6e-5 * t
    return {
        "ambient": ambient,
        "scaleX": 20.0 + 2.5 * risen(3800.0) + 0.5 * (ambient - 20.0),
        "scaleY": 20.0
        + 3.0 * risen(5200.0)
        + 0.3 * (ambient - 20.0)
        + 0.3 * np.sin(2 * np.pi * t / 7100.0 + phase[1]),
        "scaleZ": 20.0 + 2.0 * np.sin(2 * np.pi * t / 8280.0 + phase[2]),
        "spindle": 20.0 + 9.0 * risen(1440.0),
        "artefact": 20.0 + 0.8 * risen(7200.0) + 0.5 * np.sin(2 * np.pi * t / 7540.0 + phase[3]),
    }


def random_experiment(rng, label, each=10):
    """One of the three machines with random errors, a random standard and a random plan.

    Args:
        rng: Source of all that is random.
        label: Which machine.
        each: Table poses of every set-up.
    """
    machine = read_machine(MACHINES[label])
    pads = random_pads(rng)
    stated, actual = random_setups(rng, label)
    parts = []
    for k, (s, tilt, turned) in enumerate(random_poses(rng, label, len(stated), each)):
        planned = plan_pose(rng, machine, pads, stated[s], tilt, turned)
        if planned is not None:
            q, pad, place = planned
            parts.append((q, pad, place, np.full(len(pad), s), np.full(len(pad), k)))
    q = {name: np.concatenate([p[0][name] for p in parts]) for name in machine.programmed}
    n = len(q[machine.linear[0]])
    time = np.round(np.arange(n) * DURATION / n + rng.uniform(0.0, 4.0, n), 1)
    levels = np.array([0.0, 9000.0, 2000.0, 14000.0, 0.0, 6000.0, 11000.0])
    rpm = levels[np.searchsorted(np.sort(rng.uniform(0.0, 1.0, 6)), time / DURATION)]
    return Experiment(
        machine,
        label,
        pads,
        stated,
        actual,
        random_errors(rng, machine),
        q,
        np.concatenate([p[3] for p in parts]),
        np.concatenate([p[4] for p in parts]),
        np.concatenate([p[1] for p in parts]),
        tuple(np.concatenate([p[2][i] for p in parts]) for i in range(2)),
        {name: last_turn(q[name]) for name in machine.rotary},
        time,
        {k: np.round(v, 3) for k, v in temperatures(rng, time).items()},
        rpm,
    )


def last_turn(q):
    """Sign of the last move of a rotary axis at every touch; positive before the first."""
    out, sign = np.ones(len(q)), 1.0
    for i in range(1, len(q)):
        if q[i] != q[i - 1]:
            sign = 1.0 if q[i] > q[i - 1] else -1.0
        out[i] = sign
    return out


def random_noise(rng, n, hard):
    """Trigger noise (N,), mm, its standard deviation, and the rows that sit on a chip."""
    if not hard:
        return rng.normal(0.0, STATED_NOISE, n), STATED_NOISE, []
    sd = rng.uniform(0.45e-3, 0.85e-3)
    noise = rng.normal(0.0, sd, n)
    chips = np.flatnonzero(rng.uniform(size=n) < 0.01)
    noise[chips] += rng.uniform(15e-3, 60e-3, len(chips))
    return noise, sd, chips.tolist()
