"""Further laws for the exact simulator: half have a shape of the grammar, half have none.

The learner was neither made nor tuned on them, but for the square of a play, whose shape came into
the grammar later; those without a shape are sums, functions of two readings together, quicker and
slower waves of one law, and drivers that no column records.
"""

import numpy as np
from simulator_laws import Family, component, played, since_first

OUTSIDE = (
    "two_zones", "chirp", "staircase", "radius", "diagonal", "rectified", "wander",
    "late_temperature", "skewed",
)  # fmt: skip
"""Families without a formula in the grammar."""

FURTHER = (
    "dead_band", "parabola_about", "scale_joint", "room_cycle", "lubrication", "wiper",
    "half_wave", "worn_window", "cold_oil", "ring_down", *OUTSIDE, "square_of_play", "loop",
    "cogging", "overshoot",
)  # fmt: skip
"""Every further family by its word."""

SURFACES = ("two_bumps", "bent_valley", "tilted_ellipse", "twist", "corner", "spiral")
"""Functions of two readings that came after surfaces could be learnt."""


def late(s):
    """Spindle temperature less 20 degC, by a first-order lag of 40 min."""
    warm, out = s.temperature["spindle"], np.empty(len(s))
    out[0] = warm[0]
    for i, dt in enumerate(np.diff(s.time)):
        out[i + 1] = warm[i + 1] + (out[i] - warm[i + 1]) * np.exp(-dt / 2400.0)
    return out - 20.0


def wandering(s, knots):
    """A driver that nothing records: from knot to knot, from zero on."""
    whole = np.interp(s.time / 14000.0, np.linspace(0.0, 1.0, len(knots)), knots)
    return whole - whole[0]


def further_families(rng, machine) -> dict[str, Family]:
    """One law of every further family, its places drawn."""
    A = str(rng.choice(machine.linear))
    B = str(rng.choice([a for a in machine.linear if a != A]))
    own, aside, tilt = f"E{A}{A}", f"E{rng.choice(list('XYZ'))}{A}", f"E{rng.choice(list('AB'))}{A}"
    at = {"X": rng.uniform(-50, 50), "Y": rng.uniform(-40, 40), "Z": rng.uniform(-280, -220)}
    if not machine.rotary:
        at["Y"] -= 120.0
    period, phase = rng.uniform(40.0, 70.0), rng.uniform(0.0, 6.28)
    towards, knots = rng.normal(size=3), rng.normal(size=8)
    towards /= np.linalg.norm(towards)

    def x(s):
        return s.q[A] - at[A]

    def y(s):
        return s.q[B] - at[B]

    def since_pose(s):
        turned = np.sum(
            [np.abs(np.diff(s.q[a], prepend=s.q[a][0])) for a in machine.rotary], axis=0
        )
        return since_first(s, np.cumsum(turned > 1e-6))

    def ringing(s):
        return np.exp(-since_pose(s) / 150.0) * np.cos(2.0 * np.pi * since_pose(s) / 170.0)

    def everywhere(formula):
        def act(s, a):
            return {"shift": (a * 1.0e-3 * formula(s))[:, None] * towards}

        return act

    def in_time(shape, formula):
        return Family("shift", ("time",), (shape,) if shape else (), everywhere(formula))

    inside = {
        "loop": component(
            aside, (A,), ("hysteresis", "play"), lambda s: (s.q[A] - played(s.q[A], 35.0)) / 35.0
        ),
        "cogging": component(own, (A,), ("sine*window", "sine*plateau"),
            lambda s: np.sin(0.2 * np.pi * s.q[A] * 50.0 / period) * (np.abs(x(s)) < 45.0)),
        "dead_band": component(
            aside, (A,), ("dead-band",),
            lambda s: np.sign(x(s)) * np.maximum(np.abs(x(s)) - 30.0, 0.0) / 50.0,
        ),
        "parabola_about": component(tilt, (A, "T-spindle"), ("lin*quad-about", "lin*quad"),
            lambda s: (x(s) / 100.0) ** 2 * (s.temperature["spindle"] - 20.0) / 5.0),
        "scale_joint": component(own, (A,), ("step",), lambda s: (x(s) > 0.0) * 1.0),
        "room_cycle": in_time("sine", lambda s: np.sin(2.0 * np.pi * s.time / 2100.0 + phase)),
        "lubrication": component(aside, ("time",), ("pulse",),
            lambda s: np.maximum(s.time - 2500.0, 0.0) / 900.0
            * np.exp(1.0 - np.maximum(s.time - 2500.0, 0.0) / 900.0)),
        "wiper": component(own, (A, f"last-{A}"), ("lin*sign", "lin-from*sign"),
            lambda s: s.last_move[A] * x(s) / 100.0),
        "worn_window": component(aside, (A,), ("window",), lambda s: (np.abs(x(s)) < 22.0) * 1.0),
        "cold_oil": component(aside, ("T-spindle",), ("exp", "settling"),
            lambda s: np.exp(-(s.temperature["spindle"] - 20.0) / 2.5)),
        "ring_down": component(aside, ("time",), ("exp*sine", "settling*sine"),
            lambda s: np.exp(-s.time / 4000.0) * np.cos(2.0 * np.pi * s.time / 1900.0)),
    }  # fmt: skip
    outside = {
        "two_zones": component(aside, (A,), (),
            lambda s: np.exp(-(((x(s) - 60.0) / 20.0) ** 2)) - 0.7 * np.exp(-((x(s) / 35.0) ** 2))),
        "chirp": component(own, (A,), (),
            lambda s: np.sin(2.0 * np.pi * x(s) / period * (1.0 + x(s) / 400.0))),
        "staircase": component(own, (A,), (), lambda s: np.floor(x(s) / 45.0) - x(s) / 90.0),
        "radius": component(aside, (A, B), (),
            lambda s: np.exp(-((np.hypot(x(s), y(s)) - 60.0) / 25.0) ** 2)),
        "diagonal": component(aside, (A, B), (), lambda s: np.tanh((x(s) + y(s)) / 30.0)),
        "rectified": component(own, (A,), (),
            lambda s: np.abs(np.sin(np.pi * x(s) / (2.0 * period)))),
        "wander": in_time("", lambda s: wandering(s, knots)),
        "late_temperature": component(aside, ("T-spindle", B), (),
            lambda s: late(s) / 5.0 * y(s) / 100.0),
        "skewed": component(aside, (A,), (),
            lambda s: np.maximum(x(s) + 60.0, 0.0) / 40.0
            * np.exp(-((np.maximum(x(s) + 60.0, 0.0) / 60.0) ** 2))),
        "square_of_play": component(aside, ("T-scaleZ",), ("play-quad",),
            lambda s: (played(s.temperature["scaleZ"], 0.5) - 20.0) ** 2),
    }  # fmt: skip
    if machine.rotary:
        inside["overshoot"] = Family(
            "shift", ("since-pose",), ("exp*sine", "settling*sine"), everywhere(ringing)
        )
        inside["half_wave"] = component("EZC", ("C",), ("half-wave",),
            lambda s: np.maximum(np.sin(s.q["C"] + phase), 0.0))  # fmt: skip
    return inside | outside


def surfaces(rng, machine) -> dict[str, Family]:
    """One function of two readings of every kind, its place drawn."""
    A, B = (str(a) for a in rng.choice(machine.linear, 2, replace=False))
    aside, turn = f"E{rng.choice(list('XYZ'))}{A}", rng.uniform(0.0, np.pi)
    at = {"X": rng.uniform(-40, 40), "Y": rng.uniform(-30, 30), "Z": rng.uniform(-280, -220)}
    if not machine.rotary:
        at["Y"] -= 120.0

    def law(formula):
        return component(aside, (A, B), (), lambda s: formula(s.q[A] - at[A], s.q[B] - at[B]))

    def turned(formula):
        c, d = np.cos(turn), np.sin(turn)
        return law(lambda x, y: formula(c * x + d * y, c * y - d * x))

    def bump(x, y, width):
        return np.exp(-(x**2 + y**2) / width**2)

    return {
        "two_bumps": law(lambda x, y: bump(x + 50, y + 30, 35) - 0.8 * bump(x - 45, y - 40, 40)),
        "bent_valley": law(lambda x, y: np.exp(-(((y - (x / 12) ** 2 / 6 + 20) / 30) ** 2))),
        "tilted_ellipse": turned(lambda u, v: np.exp(-((u / 80) ** 2) - (v / 25) ** 2)),
        "twist": law(lambda x, y: np.tanh(x * y / 2500)),
        "corner": turned(lambda u, v: 1 / (1 + np.exp(-u / 12)) / (1 + np.exp(-v / 12))),
        "spiral": law(
            lambda x, y: np.cos(np.arctan2(y, x) - np.hypot(x, y) / 35) * bump(x, y, 140.0) ** 0.5
        ),
    }
