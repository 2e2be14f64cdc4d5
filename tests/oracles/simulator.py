"""Independent, exact simulator of probing runs with hidden effects.

The machine is a product of 4x4 matrices, the standard has curved pads, and every touch moves the
axes until the true ball meets the true surface. Nothing here comes from `twin` or from what
analyses the runs; only the truth about a case (`simulator_case`) uses the twin's columns.
"""

from dataclasses import dataclass, replace

import numpy as np
from simulator_effects import State
from simulator_experiment import LENGTH, RADIUS, STATED_NOISE, pose_about_z
from simulator_machine import tip, tip_per_linear
from simulator_surface import foot, surface_point, turn

MET = 1e-10
"""Distance of ball and surface, mm, that counts as none: a ten thousandth of the last digit."""


@dataclass
class Run:
    """What the control recorded: readings, foot points on the calibrated surface, deviations."""

    q: dict
    point: np.ndarray
    normal: np.ndarray
    deviation: np.ndarray


def ball_in_standard(e, q, errors, added):
    """True ball centre in the frame of the true standard, and how much that has grown."""
    ball = tip(e.machine, q, LENGTH, errors) - added.get("shift", 0.0)
    grown = 1.0 + added.get("growth", np.zeros(len(ball)))
    ball = ball / grown[:, None]  # the table carries the standard along from its middle
    T = np.stack(e.actual)[e.setup]
    local = turn(np.swapaxes(T[:, :3, :3], 1, 2), ball - T[:, :3, 3])
    return local, grown


def collected(e, q, hidden, state):
    """Component errors of machine and effects at readings q, and what acts elsewhere."""
    errors = {name: f(q) for name, f in e.errors.items()}
    other = {}
    state = replace(state, q=q)
    for effect in hidden:
        for key, value in effect.act(state, effect.amplitude).items():
            into = errors if key.startswith("E") else other
            if key != "form":
                into[key] = into.get(key, 0.0) + value
    return errors, other


def probe(e, hidden, noise, digits=True):
    """Run an experiment: every touch moves along its normal until ball and surface meet.

    Args:
        e: The experiment.
        hidden: Effects with their amplitudes.
        noise: Of the trigger along the normal, chips included, (N,), mm.
        digits: Whether readings are rounded as in a run file.
    """
    machine, n = e.machine, len(e.time)
    point, normal = surface_point(e.pads, e.pad, *e.place)
    T = np.stack([pose_about_z(*s) for s in e.stated])[e.setup]
    point_table = turn(T[:, :3, :3], point) + T[:, :3, 3]
    normal_table = turn(T[:, :3, :3], normal)
    D, _ = tip_per_linear(machine, e.q, LENGTH)
    velocity = -np.linalg.solve(D, normal_table[:, :, None])[:, :, 0]
    moves = {name: np.sign(velocity[:, i]) for i, name in enumerate(machine.linear)}
    moves.update(e.last_turn)
    state = State(
        machine, e.q, moves, e.time, e.temperature, e.rpm, e.setup, e.pad, point_table, normal_table
    )
    true_pads = with_form(e.pads, hidden, state)
    lift, place = np.zeros(n), e.place
    for _ in range(8):
        q = dict(e.q)
        for i, name in enumerate(machine.linear):
            q[name] = e.q[name] - velocity[:, i] * lift
        errors, other = collected(e, q, hidden, state)
        ball, grown = ball_in_standard(e, q, errors, other)
        x, y, distance = foot(true_pads, e.pad, ball, place)
        left = distance * grown - RADIUS - other.get("bias", 0.0) - noise
        lift, place = lift - left, (x, y)
        if np.abs(left).max() < MET:
            break
    return recorded(e, q, digits)


def with_form(pads, hidden, state):
    form = pads.form.copy()
    for effect in hidden:
        found = effect.act(state, effect.amplitude).get("form")
        if found is not None:
            form[found[0]] = found[1]
    return replace(pads, form=form)


def recorded(e, q, digits):
    """What a control that believes in the nominal machine makes of the readings."""
    if digits:
        q = {k: (v if k in e.machine.rotary else np.round(v, 6)) for k, v in q.items()}
    T = np.stack([pose_about_z(*s) for s in e.stated])[e.setup]
    ball = turn(np.swapaxes(T[:, :3, :3], 1, 2), tip(e.machine, q, LENGTH) - T[:, :3, 3])
    x, y, distance = foot(e.pads.without_form(), e.pad, ball, e.place)
    point, normal = surface_point(e.pads.without_form(), e.pad, x, y)
    return Run(q, point, normal, distance - RADIUS)


def run_text(e, run, with_speed):
    """The run file."""
    rotary, linear = sorted(e.machine.rotary), e.machine.linear
    head = ['# format = "run/1"', '# machine = "machine.toml"']
    head += [f"# probe = {{ radius_mm = {RADIUS}, length_mm = {LENGTH} }}"]
    head += [f"# u_um = {STATED_NOISE * 1e3:.1f}"]
    for letter, (origin, angle) in zip("abcdefgh", e.stated, strict=False):
        head += [f"# [setup.{letter}]", f"# origin_mm = [{', '.join(f'{v:.6f}' for v in origin)}]"]
        head += [f"# rotation_deg = [0.0, 0.0, {np.degrees(angle):.6f}]"]
    columns = {"feature": [f"pad{i}" for i in e.pad], "setup": ["abcdefgh"[i] for i in e.setup]}
    columns["pose"] = [str(i) for i in e.pose]
    columns["time_s"] = [f"{v:.1f}" for v in e.time]
    columns |= {f"{a}_mm": [f"{v:.6f}" for v in run.q[a]] for a in linear}
    columns |= {f"{a}_deg": [f"{np.degrees(v):.7f}" for v in run.q[a]] for a in rotary}
    columns |= {f"p{c}_mm": [f"{v:.6f}" for v in run.point[:, i]] for i, c in enumerate("xyz")}
    columns |= {f"n{c}": [f"{v:.9f}" for v in run.normal[:, i]] for i, c in enumerate("xyz")}
    columns |= {f"dir{a}": [f"{v:.0f}" for v in e.last_turn[a]] for a in rotary}
    columns |= {f"T_{k}_degC": [f"{v:.3f}" for v in e.temperature[k]] for k in e.temperature}
    if with_speed:
        columns["spindle_rpm"] = [f"{v:.0f}" for v in e.rpm]
    rows = [",".join(row) for row in zip(*columns.values(), strict=True)]
    return "\n".join([*head, ",".join(columns), *rows]) + "\n"
