"""Laws from outside any library, for the exact simulator, each by its own formula.

`law_case` simulates a machine with one law, and a second run of the same machine and law with other
set-ups, poses and noise, with and without the law: what is left of the latter is the error that the
true law itself leaves.
"""

from collections.abc import Callable
from dataclasses import replace
from typing import NamedTuple

import numpy as np
from simulator import probe, run_text
from simulator_case import TRIAL, Ordinary, read_back, visible_size
from simulator_effects import SMALL, Hidden, unit_of
from simulator_experiment import MACHINES, STATED_NOISE, random_experiment

CLOCKED = ("pump", "chiller", "ramp", "stylus", "room_cycle", "lubrication", "wander")
"""Families that follow a clock which no column records: another run meets it at another time."""

LATER = 900.0, 4000.0
"""By how much, s."""

MOST_DRAWS = 20
"""Places that are drawn for a law until an amplitude that machines have makes it visible."""

LARGEST_DEVIATION = 1.0
"""Largest deviation by a law, mm. Of a power of X over 1 m of which geometry takes up all but 30 um
touches were 3.9 mm off, which no probing cycle measures and no model of first order describes."""


class Family(NamedTuple):
    """What a law moves, of what it depends, and how it looks."""

    carrier: str
    variables: tuple[str, ...]
    shapes: tuple[str, ...]  # words of the grammar that are right
    act: Callable  # (state, amplitude) -> what it adds


def component(name, variables, shapes, formula):
    """A law of one component error."""
    return Family(name, variables, shapes, lambda s, a: {name: a * unit_of(name) * formula(s)})


def played(x, width):
    out, last = np.empty(len(x)), x[0]
    for i, value in enumerate(x):
        last = min(max(last, value - width), value + width)
        out[i] = last
    return out


def since_first(s, label):
    """Time since the first touch with the same label."""
    out = np.empty(len(s))
    for value in np.unique(label):
        rows = label == value
        out[rows] = s.time[rows] - s.time[rows].min()
    return out


def families(rng, machine) -> dict[str, Family]:
    """One law of every family, its places drawn."""
    A = str(rng.choice(machine.linear))
    own, aside = f"E{A}{A}", f"E{rng.choice(list('XYZ'))}{A}"
    axis = machine.axis(A)
    x0 = {"X": rng.uniform(-60, 60), "Y": rng.uniform(-50, 50), "Z": rng.uniform(-300, -200)}[A]
    if not machine.rotary and A == "Y":
        x0 -= 120.0
    period, tau = rng.uniform(2.5, 8.0), rng.uniform(500.0, 1200.0)
    towards = rng.normal(size=3)
    towards /= np.linalg.norm(towards)

    def worn(s):
        return 0.5 + 0.5 * np.cos(np.pi * np.clip((np.abs(s.q[A] - x0) - 25.0) / 20.0, 0.0, 1.0))

    def gate(s):
        return np.exp(-(((s.q["X"] - 10.0) / 40.0) ** 2)) * (s.q["Y"] > x0)

    def relaxing(s, a):
        amount = a * SMALL * np.exp(-since_first(s, s.setup) / tau)
        return {"shift": amount[:, None] * towards}

    out = {
        "worn_zone": component(own, (A,), ("plateau",), worn),
        "kink": component(
            aside, (A,), ("kink", "kink-before"), lambda s: np.maximum(0.0, s.q[A] - x0) / 100.0
        ),
        "saturation": component(
            aside, (A,), ("saturation",), lambda s: np.tanh((s.q[A] - x0) / 25.0)
        ),
        "encoder": component(own, (A,), ("sine",), lambda s: np.sin(2 * np.pi * s.q[A] / period)),
        "power": component(
            aside, (A,), ("power",), lambda s: ((axis.high - s.q[A]) / 300.0) ** 2.5
        ),
        "worn_backlash": component(
            own,
            (A, f"last-{A}"),
            ("sign*bump",),
            lambda s: 0.5 * s.last_move[A] * np.exp(-(((s.q[A] - x0) / 40.0) ** 2)),
        ),
        "gate": component("EZZ", ("X", "Y"), ("bump*step",), gate),
        "temperature_hysteresis": component(
            aside,
            ("T-scaleZ",),
            ("play", "hysteresis"),
            lambda s: played(s.temperature["scaleZ"], 0.7) - 20.0,
        ),
        "threshold": component(
            aside,
            ("T-spindle",),
            ("kink", "kink-before"),
            lambda s: np.maximum(0.0, s.temperature["spindle"] - 25.0),
        ),
        "temperature_position": component(
            "EZZ",
            ("T-spindle", "Y"),
            ("lin*quad",),
            lambda s: (s.temperature["spindle"] - 20.0) * (s.q["Y"] / 300.0) ** 2,
        ),
        "pump": component(
            "EZZ", ("time",), ("sine",), lambda s: np.sin(2.0 * np.pi * s.time / 1000.0 + 1.0)
        ),
        "chiller": component(
            "EXX", ("time",), ("saw",), lambda s: 2.0 * np.mod(s.time / 1300.0, 1.0) - 1.0
        ),
        "two_bodies": component(
            aside,
            ("time",),
            ("two-exp", "pulse"),
            lambda s: np.exp(-s.time / 600.0) - np.exp(-s.time / 3000.0),
        ),
        "ramp": Family(
            "bias",
            ("time",),
            ("ramp",),
            lambda s, a: {"bias": a * SMALL * np.clip((s.time - 3000.0) / 2500.0, 0.0, 1.0)},
        ),
        "stylus": Family(
            "bias", ("time",), ("step",), lambda s, a: {"bias": a * SMALL * (s.time > 6200.0)}
        ),
        "relaxing": Family("shift", ("since-setup",), ("exp", "settling"), relaxing),
    }
    if machine.rotary:
        out["harmonic_by_direction"] = component(
            "EZC",
            ("C", "last-B"),
            ("sign*harmonic",),
            lambda s: s.last_move["B"] * np.sin(2.0 * s.q["C"]),
        )
    return out


FAMILIES = (
    "worn_zone", "kink", "saturation", "encoder", "power", "worn_backlash", "gate",
    "temperature_hysteresis", "threshold", "temperature_position", "pump", "chiller", "two_bodies",
    "ramp", "stylus", "relaxing", "harmonic_by_direction",
)  # fmt: skip


def law_case(rng, label, family=None, signal_to_noise=(15.0, 60.0), poses=10, is_clock_kept=False):
    """Texts of a run, of a second one, of the second one without the laws, and the truth.

    Args:
        rng: Source of all that is random.
        label: Which machine.
        family: Word of the law, of two at once with a plus between; None hides nothing.
        signal_to_noise: Range from which the visibility of each is drawn.
        poses: Table poses of every set-up.
        is_clock_kept: Whether the second run meets every clock at the time of the first.
    """
    first, second = random_experiment(rng, label, poses), random_experiment(rng, label, poses)
    second.errors = first.errors
    hidden, truth = [], {"hidden": [], "machine": label, "noise_um": STATED_NOISE * 1e3}
    if family is not None:
        plain = run_text(first, probe(first, [], np.zeros(len(first.time))), False)
        ordinary = Ordinary(read_back(plain, MACHINES[label]).touches)
    for word in [] if family is None else family.split("+"):
        effect, about = drawn(rng, first, word, signal_to_noise, ordinary, label)
        about["clocked"] = word in CLOCKED and not is_clock_kept
        hidden.append(effect)
        truth["hidden"].append(about)
    noise, other = (rng.normal(0.0, STATED_NOISE, len(e.time)) for e in (first, second))
    again = [
        at_another_time(effect, rng.uniform(*LATER)) if about["clocked"] else effect
        for effect, about in zip(hidden, truth["hidden"], strict=True)
    ]
    return (
        run_text(first, probe(first, hidden, noise), False),
        run_text(second, probe(second, again, other), False),
        run_text(second, probe(second, [], other), False),
        truth,
    )


def at_another_time(effect, later):
    """The same law where its clock shows so many seconds more."""
    act = effect.act

    def acts(s, a):
        return act(replace(s, time=s.time + later), a)

    return replace(effect, act=acts)


def law_of(rng, machine, family):
    """The law of a family, its places drawn; of the further families, too."""
    known = families(rng, machine)
    if family in known:
        return known[family]
    # which is made of this module's pieces
    from simulator_further_laws import SURFACES, further_families, surfaces

    made = surfaces if family in SURFACES else further_families
    return made(rng, machine)[family]


def drawn(rng, experiment, family, signal_to_noise, ordinary, label):
    """One hidden law of a family that an amplitude which machines have makes visible."""
    for _ in range(MOST_DRAWS):
        law = law_of(rng, experiment.machine, family)
        effect = Hidden(f"?{family}", "unknown", law.act)
        per_unit, signature = visible_size(experiment, effect, ordinary, STATED_NOISE)
        effect.amplitude = rng.uniform(*signal_to_noise) / max(per_unit, 1e-9)
        deviation = effect.amplitude / TRIAL * np.abs(signature).max()
        if effect.amplitude < effect.largest and deviation < LARGEST_DEVIATION:
            break
    else:
        raise ValueError(f"{family} is never visible on {label}")
    return effect, {
        "effect": effect.name,
        "family": family,
        "shapes": list(law.shapes),
        "carrier": law.carrier,
        "variables": list(law.variables),
        "amplitude": round(float(effect.amplitude), 4),
        "signal_to_noise": round(float(per_unit * effect.amplitude), 2),
    }


def local_law(rng, machine):
    """A law that acts in one part of the travels: effect, carrier, and how much of it where.

    Returns:
        `Hidden`, the component error that it adds to, and a function of the state that is 1 where
        the law is whole and 0 where it does not act.
    """
    own = machine.axis(str(rng.choice(machine.programmed)))
    carrier = f"E{rng.choice(list('XYZABC'))}{own.name}"
    linear = [machine.axis(name) for name in rng.permutation(machine.linear)]
    one, other = linear[0], linear[1]
    if own.rotary:
        turn = rng.uniform(0.0, 2.0 * np.pi)

        def part(s):
            return (np.cos(s.q[own.name] - turn) > 0.5).astype(float)

    elif rng.uniform() < 0.5:
        shape = rng.choice(["zone", "hose"])
        along = own if shape == "zone" else one

        def part(s):
            x = s.q[along.name]
            low, high = np.quantile(x, (0.1, 0.9))
            middle, width = 0.5 * (low + high) + place * (high - low), 0.15 * (high - low)
            distance = np.abs(x - middle) / width
            return np.clip(2.0 - distance, 0.0, 1.0) if shape == "zone" else np.exp(-(distance**2))

        place = rng.uniform(-0.35, 0.35)
    else:
        signs = rng.choice([-1.0, 1.0], 2)

        def part(s):
            out = np.ones(len(s))
            for axis, sign in zip((one, other), signs, strict=True):
                x = s.q[axis.name]
                distance = sign * (x - np.median(x)) / np.ptp(x)
                out = out / (1.0 + np.exp(-distance / 0.03))
            return out

    law = component(carrier, (), (), part)
    return Hidden(f"?local({carrier})", "unknown", law.act), carrier, part
