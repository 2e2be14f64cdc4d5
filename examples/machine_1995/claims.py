"""What Chen claims in 1995, on the exact twin of his machine: `python claims.py`.

The machine is measured as he did, cold, with a laser and a level; what is learnt compensates the
true machine, once as a rigid body and once with a pitch of X that depends on Z. Every figure that
is put in stands here: PUBLISHED, or ASSUMED where the paper does not give it. Results are only what
a compensation leaves; how large an error was before it follows from what is put in.
"""

import tempfile
from importlib.resources import files
from pathlib import Path

import numpy as np
import warm_up

from matstd.compensation.field import MachineErrors, correction, deviation_after, shifted
from matstd.diagnosis.drift import chosen, joined, judge, offered, read_log
from matstd.twin.compute import silent
from matstd.twin.files import read_machine
from matstd.twin.library import parse_effect
from matstd.twin.machine import tip
from matstd.twin.units import UM, URAD

MACHINE = Path(str(files("matstd").joinpath("machines", "hmc1995.toml")))

# Published: 90 um in 750 mm of X, 157 um in 500 mm of Z, pitch 12 arcsec along X and 46 along Z;
# ASSUMED: the 157 um were read at the height of the first line along Z, 70 mm below our zero.
PUBLISHED = {"EXX": 45.0 * UM, "EZZ": 109.0 * UM, "EAZ": 133.8 * URAD}
# ASSUMED: the pitch of X is 58 urad over its travel at Z 0, as published, and -62 at Z -500. Fig. 6
# shows a few arcsec of this 25; nothing else in the paper makes 30 um of over-compensation. Of the
# 90 um between the two lines along Z, pitch makes 71. X rides on Z, so no rigid error of Z depends
# on x: 16 um of the rest are a positioning of Z that does, which is not measured here.
ASSUMED = {"ECX": 7.0 * URAD, "coupling(ECX,Z)": -36.0 * URAD, "coupling(EZZ,X)": 6.0 * UM}
# ASSUMED: after 8 h the screws have grown by 298 ppm along Y (so that holes are 92 um off, as in
# Fig. 22) and by -33 ppm along X. The models know this growth exactly: nothing here measures it.
WARM = {"EYY": 298e-6 * 250.0, "EXX": -33e-6 * 375.0}
LASER, LEVEL = 1.0 * UM, 1.0 * URAD  # standard uncertainties of one reading

LINES = {1: (-85.0, -500.0), 2: (250.0, -500.0), 3: (250.0, 0.0), 4: (150.0, -500.0)}
"""ASSUMED: height and Z of the four lines along X; the paper draws them without numbers."""


def effect(chain, name):
    return parse_effect(name if "(" in name else f"geometric({name},1)", chain)


def machine(chain, sizes):
    """A machine with errors of known size: slopes over the travel, and couplings."""
    known = [(effect(chain, n), np.array([v])) for n, v in sizes.items()]
    return MachineErrors.of_errors(chain, known)


def poses(errors, at, axis, values):
    q = np.zeros((len(values), len(errors.chain.axes)))
    for name, value in {**at, axis: values}.items():
        q[:, errors.chain.axis_index(name)] = value
    return errors.touches(q, 0.0)


def line(truth, model, axis, at, ends, rng=None):
    """Distance errors along a line, mm, relative to its first point; None as model: without."""
    touches = poses(truth, at, axis, np.linspace(*ends, 16))
    added = 0.0 * touches.q if model is None else correction(model, touches)
    moved = deviation_after(truth, touches, added)
    which = truth.chain.axis_index(axis)
    along = tip(truth.chain, shifted(touches, 0.0 * added).q, 0.0)
    step = along[-1] - along[0]
    out = (moved - moved[0]) @ (step / np.linalg.norm(step))
    assert np.ptp(touches.q[:, which]) > 0.0
    return out if rng is None else out + LASER * rng.standard_normal(len(out))


def angles(truth, name, axis, at, ends, rng):
    """What a level reads of one angle along an axis, rad, and the readings in travels."""
    touches = poses(truth, at, axis, np.linspace(*ends, 16))
    i, c = truth.chain.link_index(axis), "XYZABC".index(name[1])
    reading = truth.contribution(touches).twist[:, i, c]
    scaled = truth.chain.link(axis).scaled(touches.reading(axis))
    return scaled, reading + LEVEL * rng.standard_normal(16)


def slope(scaled, readings):
    return float(np.polyfit(scaled, readings, 1)[0])


def learnt(truth, rng, is_rigid):
    """A model from a cold machine: angles by a level, then positions by a laser at one height."""
    chain, found = truth.chain, {}
    x_ends, z_ends = (-375.0, 375.0), (-500.0, 0.0)
    near = slope(*angles(truth, "ECX", "X", {"Z": 0.0}, x_ends, rng))
    far = slope(*angles(truth, "ECX", "X", {"Z": -500.0}, x_ends, rng))
    if is_rigid:
        found["ECX"] = near  # one line along X, as everybody measures
    else:
        u = float(chain.link("Z").scaled(np.array(-500.0)))
        found["coupling(ECX,Z)"] = (near - far) / (1.0 - u)
        found["ECX"] = near - found["coupling(ECX,Z)"]
    found["EAZ"] = slope(*angles(truth, "EAZ", "Z", {}, z_ends, rng))
    for name, axis, ends in (("EXX", "X", x_ends), ("EZZ", "Z", z_ends)):
        rest = line(truth, machine(chain, found), axis, {}, ends, rng)
        scaled = chain.link(axis).scaled(np.linspace(*ends, 16))
        found[name] = slope(scaled, rest)
    return found


def hole_pattern(truth, model):
    """Largest error of the distances of four holes, 410 by 304 mm, mm."""
    corners = [(x, y) for y in (-54.0, 250.0) for x in (-205.0, 205.0)]
    q = np.zeros((4, len(truth.chain.axes)))
    for k, (x, y) in enumerate(corners):
        for name, value in (("X", x), ("Y", y), ("Z", -500.0)):
            q[k, truth.chain.axis_index(name)] = value
    touches = truth.touches(q, 0.0)
    moved = deviation_after(
        truth, touches, 0.0 * q if model is None else correction(model, touches)
    )
    sides = [(1, 0, 0), (3, 2, 0), (2, 0, 1), (3, 1, 1)]
    return max(abs(float(moved[a, c] - moved[b, c])) for a, b, c in sides)


def step_of_two_cuts(seed):
    """Largest step between a cut in the cold and one within 8 h, without and with a law, um.

    The drift is that of `warm_up.py` at random speeds; the law is learnt at five constant ones.
    """
    with tempfile.TemporaryDirectory() as folder:
        warm_up.main(folder, seed)
        logs = [read_log(Path(folder) / f"{n}.csv", 900.0) for n in ("train", "random")]
    record = joined(logs)
    train = np.arange(len(logs[0]))
    held = np.arange(len(train), len(train) + 32)  # eight hours
    judged = judge(record, train, held, offered(record), silent)
    best = chosen(judged, record)
    z = record.components.index("z")
    true = record.displacement[held, z]
    left = true - best.law.predicted(record)[held, z]
    at = int(np.argmax(np.abs(true - true[0])))
    return [abs(float(v[at] - v[0])) / UM for v in (true, left)]


def geometry(seed=1995):
    """Errors before, with the rigid model and with the other one, um, line by line."""
    rng = np.random.default_rng(seed)
    chain = read_machine(MACHINE)
    truth = machine(chain, {**PUBLISHED, **ASSUMED})
    models = {w: learnt(truth, rng, w == "rigid") for w in ("rigid", "non-rigid")}
    cold = {w: machine(chain, m) for w, m in models.items()}
    out = {}
    for name, x, y in (("1", -340.0, -10.0), ("2", 265.0, 310.0)):
        at = {"X": x, "Y": y - 60.0}
        both = [line(truth, m, "Z", at, (-500.0, 0.0)) for m in (None, cold["non-rigid"])]
        out[f"Z, line {name}"] = [float(np.abs(v).max()) / UM for v in both]
    for number, (y, z) in LINES.items():
        at = {"Y": y, "Z": z}
        ways = [line(truth, m, "X", at, (-375.0, 375.0)) for m in (None, *cold.values())]
        out[f"X, line {number}"] = [float(v[np.argmax(np.abs(v))]) / UM for v in ways]
    hot = machine(chain, grown({**PUBLISHED, **ASSUMED}))
    ways = [None, *(machine(chain, grown(m)) for m in models.values())]
    out["holes"] = [hole_pattern(hot, m) / UM for m in ways]
    return out


def grown(sizes):
    """Errors of a machine after 8 h."""
    return {name: sizes.get(name, 0.0) + WARM.get(name, 0.0) for name in {**sizes, **WARM}}


def main(seed=1995):
    """All of it: lines along Z, lines along X, holes, the step of two cuts."""
    return {**geometry(seed), "step": step_of_two_cuts(seed)}


if __name__ == "__main__":
    for what, values in main().items():
        print(f"{what:<12}" + " -> ".join(f"{v:7.1f}" for v in values))
