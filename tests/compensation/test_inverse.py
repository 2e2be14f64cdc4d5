"""The inverse of the exact twin, against a second model of the machine that shares no code."""

import json

import numpy as np
import pytest
from bench import LENGTH, oracle_tip, part_program

from matstd.compensation.field import (
    MachineErrors,
    State,
    aligned,
    correction,
    deviation_after,
    relative_columns,
    result_of,
    sample_workspace,
)
from matstd.compensation.programs import compensated, write_program_result
from matstd.diagnosis.files import SavedModel
from matstd.diagnosis.files.model_file import SourceEntry
from matstd.diagnosis.fit import Prior
from matstd.report.compensation import program_lines
from matstd.twin.effects.setup_error import SetupError
from matstd.twin.errors import BadValue, NotReachable
from matstd.twin.library import parse_effect
from matstd.twin.model import Model
from matstd.twin.numbers import rms_length
from matstd.twin.units import NM, UM, URAD


def test_the_corrected_machine_stands_where_it_should(known, bench_chain, poses):
    """Second model of the machine, second formulas of its errors: what is left is rounding."""
    touches = known.touches(poses, LENGTH)
    added = correction(known, touches)
    before = oracle_tip(poses, bench_chain) - oracle_tip(poses, bench_chain, False)
    after = oracle_tip(poses + added, bench_chain) - oracle_tip(poses, bench_chain, False)
    assert rms_length(before) > 50 * UM
    assert np.abs(after).max() < 3 * NM  # the oracle turns about x, y, z in order
    rotary = [bench_chain.axis_index(a) for a in bench_chain.rotary_axes]
    assert not added[:, rotary].any()


def test_at_the_datum_nothing_moves(known, datum):
    touches = known.touches(datum.q[None], LENGTH)
    assert np.abs(correction(known, touches, datum.deviation(known))).max() < 1 * NM
    assert np.abs(correction(known, touches)).max() > 10 * UM


def test_the_workspace_is_covered_evenly(bench_chain):
    q = sample_workspace(bench_chain, {"X": (-50.0, 50.0)}, 400)
    x = q[:, bench_chain.axis_index("X")]
    assert np.all(np.abs(x) <= 50.0)
    assert np.abs(np.histogram(x, 10, (-50.0, 50.0))[0] - 40).max() <= 4
    assert not q[:, bench_chain.axis_index("C1")].any()


def test_errors_too_large_do_not_close(bench_chain):
    wild = [(parse_effect("geometric(EXX,sinusoidal,100)", bench_chain), np.array([20.0]))]
    errors = MachineErrors.of_errors(bench_chain, wild)
    with pytest.raises(NotReachable, match="does not close"):
        correction(errors, errors.touches(sample_workspace(bench_chain, {}, 5), LENGTH))


def test_alignment_takes_off_rigid_motions_and_no_more():
    rng = np.random.default_rng(3)
    points = rng.uniform(-200, 200, (30, 3))
    rigid = np.array([0.1, -0.2, 0.3]) + np.cross([1e-4, 2e-4, -3e-4], points)
    assert np.abs(aligned(points, rigid)).max() < 1e-12
    bent = rigid + np.column_stack([points[:, 1] ** 2 * 1e-6, 0 * points[:, 0], 0 * points[:, 0]])
    left = aligned(points, bent)
    assert 1e-4 < np.abs(left).max() < 0.04
    np.testing.assert_allclose(aligned(points, left), left, atol=1e-12)


def saved(chain, effects, mean, covariance):
    return SavedModel(
        model=Model(chain, effects),
        estimates=Prior.of_estimates(np.array(mean), np.array(covariance)),
        source=SourceEntry(run="r.csv", touches=10, noise_um=0.5),
        from_inner=np.zeros((len(mean), 0)),
        reported={},
    )


def test_what_only_the_measurement_had_is_not_compensated(bench_chain, datum):
    names = ["location(EX0t)", "geometric(EXC1,linear)", "probe-radius", "backlash(X)"]
    effects = [SetupError("a", (0.0, 0.0, 0.0))]
    effects += [parse_effect(name, bench_chain) for name in names]
    n = 6 + len(names)
    errors = MachineErrors.of_model(saved(bench_chain, tuple(effects), np.ones(n), np.eye(n)))
    assert [e.name for e in errors.effects] == ["backlash(X)"]
    assert errors.left_out == ("setup(a)", *names[:3])


def test_a_tool_set_against_the_probe_shares_its_place(bench_chain):
    """EX0X - EX0t is known to 1 µm, each alone to 50 µm: with the probe as it is, 1 µm is left."""
    effects = tuple(parse_effect(f"location({s})", bench_chain) for s in ("EX0X", "EX0t"))
    shared, own = 50 * UM, 1 * UM
    covariance = [[shared**2 + own**2, shared**2], [shared**2, shared**2]]
    errors = MachineErrors.of_model(saved(bench_chain, effects, [0.0, 0.0], covariance))
    np.testing.assert_allclose(np.linalg.norm(errors.root), own, rtol=1e-6)
    np.testing.assert_allclose(np.linalg.norm(errors.tool_root), shared, rtol=1e-6)


CORNERS = ["X+50 Y+50", "X-50 Y+50", "X-50 Y-50", "X+50 Y-50"]


def test_a_program_states_for_which_tools_its_uncertainty_holds(bench_chain, frame, head, tmp_path):
    """EX0C less EX0t is known to 1 um, each alone to 20 um.

    The line of C that is off by e puts the part that is turned by 180 degrees 2e beside the other;
    the alignment halves that. A part that is milled without a turn does not feel it.
    """
    effects = tuple(parse_effect(f"location({s})", bench_chain) for s in ("EX0C", "EX0t"))
    shared, own = 20 * UM, 1 * UM
    covariance = [[shared**2 + own**2, shared**2], [shared**2, shared**2]]
    errors = MachineErrors.of_model(saved(bench_chain, effects, [0.0, 0.0], covariance))
    said, found = [], []
    for second in (0, 180):
        blocks = [f"L {at} Z+0 B+0 C+{c} F MAX" for c in (0, second) for at in CORNERS]
        text = "\n".join(["BEGIN PGM A MM", *blocks, "END PGM A MM", ""])
        found.append(compensated(part_program(text, frame, tmp_path), errors, head))
        said.append(" ".join(program_lines("a", found[-1])))
    np.testing.assert_allclose([one.u_tool for one in found], [0.0, shared], rtol=1e-3, atol=NM)
    np.testing.assert_allclose(rms_length(found[1].u[:, None]), own, rtol=1e-3)
    caveat = (
        "1.0 µm there with tools set relative to the probe of the measurement (20 µm with others)"
    )
    assert caveat in said[1]
    assert "with others" not in said[0]
    write_program_result(tmp_path / "a.json", found[1])
    assert json.loads((tmp_path / "a.json").read_text())["tool_u_um"] == pytest.approx(
        20.0, rel=1e-3
    )


def test_uncertainty_of_the_result_is_that_of_drawn_machines(bench_chain, datum):
    """What is left after compensation by estimates that are wrong by what they may be."""
    rng = np.random.default_rng(5)
    names = ["geometric(EXX,linear)", "location(EC0Y)", "geometric(EBX,parabolic)"]
    effects = tuple(parse_effect(name, bench_chain) for name in names)
    sd = np.array([2 * UM, 5 * URAD, 4 * URAD])
    mean = np.array([20 * UM, 40 * URAD, 30 * URAD])
    errors = MachineErrors.of_model(saved(bench_chain, effects, mean, np.diag(sd**2)))
    q = sample_workspace(bench_chain, {}, 30)
    found = result_of(errors, lambda t: correction(errors, t), q, datum)
    assert rms_length(found.after) < 1 * NM
    touches = errors.touches(q, LENGTH)
    added = correction(errors, touches)
    drawn = []
    for _ in range(100):
        theta = mean + sd * rng.normal(size=3)
        true = MachineErrors.of_errors(
            bench_chain, [(e, theta[[k]]) for k, e in enumerate(effects)]
        )
        drawn.append(rms_length(aligned(touches.point, deviation_after(true, touches, added))) ** 2)
    np.testing.assert_allclose(np.sqrt(np.mean(drawn)), found.u_rms, rtol=0.15)


def test_switches_scale_by_every_word(known):
    at = known.touches(np.zeros((1, 6)) + 0.3, LENGTH)
    whole = known.columns(at) @ np.concatenate(known.theta)
    off = known.switched({"all": 0.0})
    assert not np.concatenate(off.theta).any()
    only = known.switched({"all": 0.0, "EXX": 2.0})
    assert [e.symbol.name for e, t in zip(only.effects, only.theta, strict=True) if t.any()] == [
        "EXX"
    ]
    rotary = known.switched({"rotary_tilt": 0.0})
    off = {e.symbol.name for e, t in zip(rotary.effects, rotary.theta, strict=True) if not t.any()}
    assert off == {"EA0C"}
    x = known.switched({"X": 0.0})
    off = {e.symbol.name for e, t in zip(x.effects, x.theta, strict=True) if not t.any()}
    assert off == {"EXX", "EZX", "EBX", "EX0X"}
    half = known.switched({"all": 0.5})
    np.testing.assert_allclose(half.columns(at) @ np.concatenate(half.theta), 0.5 * whole)
    with pytest.raises(BadValue, match=r"EXY'.*expected one of"):
        known.switched({"EXY": 0.0})


def test_the_thermal_state_counts(bench_chain, datum):
    effect = parse_effect("thermal-lag(EZZ)", bench_chain)
    growth = [(effect, np.array([40 * UM]))]
    late = MachineErrors.of_errors(bench_chain, growth, State(time=1e9))
    half = MachineErrors.of_errors(bench_chain, growth, State(time=effect.tau * np.log(2.0)))
    q = datum.q[None]
    for errors, expected in ((late, 40 * UM), (half, 20 * UM)):
        added = correction(errors, errors.touches(q, LENGTH))
        z = bench_chain.axis_index("Z")
        np.testing.assert_allclose(added[0, z], -expected, atol=1 * NM)
    assert np.abs(relative_columns(late, late.touches(q, LENGTH), datum)).max() == 0.0
