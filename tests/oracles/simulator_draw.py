"""Random hidden effects of a case."""

import numpy as np
import simulator_effects as fx


def random_direction(rng):
    v = rng.normal(size=3)
    return v / np.linalg.norm(v)


def draw(rng, machine, hard, pads=11):
    """One random effect of a kind that this machine can have; harder cases know more kinds."""
    kinds = ["coupling", "backlash", "periodic", "expansion", "lag", "standard", "slip", "lobes"]
    kinds += ["radius", "gravity"] + (["harmonic"] if machine.rotary else [])
    if hard:
        kinds += ["speed", "drift", "stylus", "form"]
    kind = str(rng.choice(kinds))
    axes = machine.programmed
    turn = rng.uniform(0.0, 2.0 * np.pi)
    minutes = rng.uniform(10.0, 40.0)
    if kind == "coupling":
        own, other = rng.choice(axes, 2, replace=False)
        return fx.coupling(f"E{rng.choice(list('ABC'))}{own}", str(other))
    if kind == "backlash":
        return fx.backlash(str(rng.choice(axes)))
    if kind == "periodic":
        axis = str(rng.choice(machine.linear))
        return fx.periodic(
            f"E{axis}{axis}", float(rng.choice([4.0, 5.0, 8.0, 10.0, 12.0, 16.0])), turn
        )
    if kind == "harmonic":
        axis = str(rng.choice(machine.rotary))
        return fx.harmonic(f"E{rng.choice(list('XYZABC'))}{axis}", int(rng.integers(2, 5)), turn)
    if kind == "expansion":
        axis = str(rng.choice(machine.linear))
        return fx.scale_growth(axis, f"scale{axis}")
    if kind in ("lag", "speed"):
        letters = "XYZ" if rng.uniform() < 0.7 else "ABC"
        component = f"E{rng.choice(list(letters))}{rng.choice(axes)}"
        return (fx.warm_up if kind == "lag" else fx.after_speed)(component, float(minutes))
    if kind == "gravity":
        tilting = [a for a in machine.rotary if a[0] in "AB"]
        return fx.tilting_weight(str(rng.choice(tilting))) if tilting else fx.sagging_ram("EYZ")
    simple = {
        "standard": lambda: fx.growth_of_standard("artefact"),
        "slip": lambda: fx.slip(float(rng.uniform(0.15, 0.85)), random_direction(rng)),
        "lobes": lambda: fx.lobes(int(rng.integers(2, 6)), turn),
        "radius": fx.ball_too_large,
        "drift": lambda: fx.drift(random_direction(rng)),
        "stylus": fx.bending_stylus,
        "form": lambda: fx.form_of_pad(int(rng.integers(pads)), random_wave(rng)),
    }
    return simple[kind]()


def random_wave(rng):
    k, m = 2.0 * np.pi / rng.uniform(38.0, 60.0, 2)
    f, g = rng.uniform(0.0, 2.0 * np.pi, 2)
    return np.array([1.0, k, f, m, g])


def draw_unknown(rng):
    """One random effect from outside any library."""
    turn = rng.uniform(0.0, 2.0 * np.pi)
    which = rng.integers(3)
    if which == 0:
        return fx.cable(rng.uniform(-60.0, 60.0), rng.uniform(20.0, 50.0), rng.uniform(-60.0, 30.0))
    if which == 1:
        return fx.pump(rng.uniform(300.0, 1500.0), turn)
    return fx.chiller(rng.uniform(400.0, 1500.0), rng.uniform())
