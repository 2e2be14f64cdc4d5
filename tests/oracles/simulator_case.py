"""Cases with known truth: a random experiment, hidden effects of a chosen size, and the answer.

`simulate_case` returns the texts of a run file and a machine file and the truth, which states how
visible each effect is beside an ordinary geometric model and what could be mistaken for it. Only
for that last part the columns of `twin` are used.
"""

import re
import tempfile
from pathlib import Path

import numpy as np
import simulator_effects as effects
from simulator import probe, run_text
from simulator_draw import random_direction, random_wave
from simulator_experiment import MACHINES, STATED_NOISE, random_experiment, random_noise

from matstd.twin.files import read_run
from matstd.twin.library import ordinary_model, proposals
from matstd.twin.model import columns, is_tunable

DETECTABLE = 9.0
ALIKE = 0.93
"""Share of a signature that an effect must reproduce to be as right an answer as the truth."""
TRIAL = 5.0
"""Amplitude at which the signature of an effect is taken, um, urad, um/(m K)."""


def named(rng, machine, name):
    """Hidden effect by its name, inner parameters drawn."""
    word, inside = re.fullmatch(r"([?\w-]+)(?:\((.*)\))?", name).groups()
    arguments = inside.split(",") if inside else []
    turn, minutes = rng.uniform(0.0, 2.0 * np.pi), float(rng.uniform(10.0, 40.0))
    if word == "periodic":
        if machine.axis(arguments[0][2:]).rotary:
            return effects.harmonic(arguments[0], int(rng.integers(2, 5)), turn)
        return effects.periodic(arguments[0], float(rng.choice([4.0, 5.0, 8.0, 10.0, 12.0])), turn)
    if word == "thermal-lag":
        if len(arguments) == 1:
            return effects.warm_up(arguments[0], minutes)
        if arguments[1] == "spindle_rpm":
            return effects.after_speed(arguments[0], minutes)
        return effects.after_sensor(*arguments, minutes)
    if word == "gravity":
        if len(arguments) == 2:
            return effects.load_off_centre(*arguments, turn)
        axis = arguments[0][2:]
        turns = machine.axis(axis).rotary
        return effects.tilting_weight(axis) if turns else effects.sagging_ram(arguments[0])
    simple = {
        "coupling": lambda: effects.coupling(*arguments),
        "backlash": lambda: effects.backlash(*arguments),
        "thermal-expansion": lambda: effects.scale_growth(*arguments),
        "geometric": lambda: effects.quartic(arguments[0]),
        "artefact-expansion": lambda: effects.growth_of_standard(*arguments),
        "artefact-slip": lambda: effects.slip(
            float(rng.uniform(0.15, 0.85)), random_direction(rng)
        ),
        "artefact-form": lambda: effects.form_of_pad(
            int(arguments[0].removeprefix("pad")), random_wave(rng)
        ),
        "drift": lambda: effects.drift(random_direction(rng)),
        "probe-lobing": lambda: effects.lobes(int(rng.integers(2, 6)), turn),
        "probe-radius": effects.ball_too_large,
        "stylus-bending": effects.bending_stylus,
        "?cable": lambda: effects.cable(rng.uniform(-60, 60), rng.uniform(20, 50), -20.0),
        "?pump": lambda: effects.pump(rng.uniform(300.0, 1500.0), turn),
        "?chiller": lambda: effects.chiller(rng.uniform(400.0, 1500.0), rng.uniform()),
    }
    return simple[word]()


class Ordinary:
    """What an ordinary geometric model with free set-ups can imitate at some touches."""

    def __init__(self, touches):
        self.touches = touches
        n, c = touches.normal_table, touches.point_table
        blocks = [ordinary_model(touches.chain).columns(touches)]
        for s in range(len(touches.setups)):
            inside = (touches.setup == s)[:, None]
            if not inside.any():  # no touch of this set-up was within all travels
                continue
            arm = c - c[touches.setup == s].mean(axis=0)
            blocks += [inside * n, inside * np.cross(arm, n) / 100.0]
        A = np.hstack(blocks)
        size = np.linalg.norm(A, axis=0)
        A = A[:, size > 1e-9 * size.max()]
        U, s, _ = np.linalg.svd(A / np.linalg.norm(A, axis=0), full_matrices=False)
        self.basis = U[:, s > 1e-6 * s[0]]

    @property
    def rank(self):
        return self.basis.shape[1]

    def left(self, v):
        """What of a signature (N,) or of columns (N, K) no ordinary model can imitate."""
        return v - self.basis @ (self.basis.T @ v)

    def alike(self, signature, own_name):
        """(share, name, kind) of the library's effects that reproduce most of a signature.

        Pitches of screws and scales are left out: a narrow peak over many periods is like nothing.
        """
        target = self.left(signature)
        target = target / np.linalg.norm(target)
        found = []
        for effect in proposals(self.touches):
            inner = effect.inner(self.touches)[0] if is_tunable(effect) else None
            if effect.name == own_name or (inner is not None and inner.acts == "with a period"):
                continue
            variants = [effect] if inner is None else [effect.tuned(v) for v in inner.grid]
            share = self.best_share(target, columns(variants, self.touches), len(variants))
            found.append([round(share, 4), effect.name, effect.kind])
        return sorted(found, reverse=True)

    def best_share(self, target, blocks, count):
        """Longest part of a unit vector that lies in the span of what is left of one block.

        Args:
            target: Unit vector, (N,).
            blocks: Columns of all variants of an effect, (N, count * K).
            count: How many variants.
        """
        W, before = self.left(blocks), np.linalg.norm(blocks, axis=0)
        size = np.linalg.norm(W, axis=0)
        best = 0.0
        for i in range(count):
            part = slice(i * W.shape[1] // count, (i + 1) * W.shape[1] // count)
            seen = size[part] > 1e-7 * np.maximum(before[part], 1e-300)
            if np.any(seen):
                U, s, _ = np.linalg.svd(W[:, part][:, seen] / size[part][seen], full_matrices=False)
                best = max(best, float(np.linalg.norm(U[:, s > 1e-6].T @ target)))
        return best


def read_back(run_file, machine_file):
    with tempfile.TemporaryDirectory() as folder:
        (Path(folder) / "machine.toml").write_text(machine_file)
        (Path(folder) / "run.csv").write_text(run_file)
        return read_run(Path(folder) / "run.csv")


def visible_size(e, effect, ordinary, noise):
    """Signal to noise per unit amplitude, and the signature (N,) of the trial amplitude."""
    still = np.zeros(len(e.time))
    effect.amplitude = TRIAL
    signature = probe(e, [effect], still, digits=False).deviation
    signature = signature - probe(e, [], still, digits=False).deviation
    return float(np.linalg.norm(ordinary.left(signature)) / noise / TRIAL), signature


def simulate_case(
    rng,
    machine="hsm600u",
    hidden=(),
    hard=False,
    signal_to_noise=(12.0, 40.0),
    with_alike=True,
    keep_weak=False,
    poses=10,
):
    """One case: texts of the run file and the machine file, and the truth.

    Args:
        rng: Source of all that is random.
        machine: "hsm600u", "fork" or "hmc1995".
        hidden: Names of effects (inner parameters drawn), `Hidden` effects, or functions of
            (rng, machine) that draw one; one that no amplitude makes visible is drawn again.
        hard: Chips, a noise that is not what the file states, a spindle that runs.
        signal_to_noise: Range from which the visibility of each effect is drawn.
        with_alike: Whether the truth states what could be mistaken for each effect (a second).
        keep_weak: Whether an effect stays whose largest amplitude cannot be detected.
        poses: Table poses of every set-up, of some two dozen touches each.
    """
    e = random_experiment(rng, machine, poses)
    n = len(e.time)
    noise, sd, chips = random_noise(rng, n, hard)
    plain = probe(e, [], np.zeros(n))
    run = read_back(run_text(e, plain, hard), MACHINES[machine])
    ordinary = Ordinary(run.touches)
    chosen, stated = [], []
    for wanted in hidden:
        taken = [c.name for c in chosen]
        effect, truth = place_one(rng, e, wanted, ordinary, sd, signal_to_noise, keep_weak, taken)
        if with_alike and effect.kind != "unknown":
            ranked = ordinary.alike(truth.pop("signature"), effect.name)
            truth["alike"] = [r for r in ranked if r[0] > ALIKE]
            truth["nearest"] = ranked[0][:2]
        truth.pop("signature", None)
        chosen.append(effect)
        stated.append(truth)
    text = run_text(e, probe(e, chosen, noise), hard)
    residual = ordinary.left(read_back(text, MACHINES[machine]).deviation)
    return (
        text,
        MACHINES[machine],
        {
            "hidden": stated,
            "touches": n,
            "rank": ordinary.rank,
            "chi2_ratio_baseline": round(
                float(residual @ residual) / (n - ordinary.rank) / STATED_NOISE**2, 3
            ),
            "noise_um": sd * 1e3,
            "chips": chips,
            "machine": machine,
        },
    )


def place_one(rng, e, wanted, ordinary, noise, visibility, keep_weak, taken):
    """Effect with an amplitude that gives it the wanted visibility, and the truth about it."""
    for _ in range(50):
        effect = wanted
        if isinstance(wanted, str):
            effect = named(rng, e.machine, wanted)
        elif callable(wanted):
            effect = wanted(rng, e.machine)
            if effect.name in taken:
                continue
        given = effect.amplitude
        per_unit, signature = visible_size(e, effect, ordinary, noise)
        effect.amplitude = given or min(
            rng.uniform(*visibility) / max(per_unit, 1e-9), effect.largest
        )
        seen = per_unit * effect.amplitude
        if seen > DETECTABLE or given or keep_weak:
            break
    else:
        raise ValueError(f"{wanted} is never visible on {e.label}")
    truth = {
        "effect": effect.name,
        "kind": effect.kind,
        "amplitude": round(float(effect.amplitude), 4),
        "signal_to_noise": round(seen, 2),
        "detectable": bool(seen > DETECTABLE),
        "inner": effect.inner,
        "alike": [],
        "signature": signature,
    }
    return effect, truth
