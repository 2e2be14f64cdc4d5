"""Zeros of joints and lengths of links, against Denavit and Hartenberg's products by hand."""

import numpy as np
import pytest

from matstd.diagnosis.fit import fit_run
from matstd.diagnosis.geometry import found_arm, geometry_rows
from matstd.diagnosis.remarks import What, noticed, remarks
from matstd.importers import read_sheet
from matstd.importers.arms import arm_from_dh, read_arm, tracker_run
from matstd.report.geometry import quantity_name
from matstd.twin.library import ordinary_model
from matstd.twin.model import Model
from matstd.twin.units import DEG, UM, URAD

A = np.array([350.0, 1150.0, 41.0, 0.0, 0.0, 0.0])
ALPHA = np.array([-90.0, 0.0, -90.0, 90.0, -90.0, 0.0]) * DEG
D = np.array([675.0, 0.0, 0.0, 1200.0, 0.0, 215.0])
THETA = np.array([0.0, -90.0, 0.0, 0.0, 0.0, 0.0]) * DEG
REFLECTOR = [25.0, 62.0, 30.0, 1.0]
POSES = 45

PLANTED = {
    # where a joint of the arm is another than the table says: array, index, step and symbol
    "zero": (THETA, 2, 60.0 * URAD, "EB0B1"),
    "wrist zero": (THETA, 4, -80.0 * URAD, "EB0B2"),
    "upper arm": (A, 1, 90.0 * UM, "a(B,B1)"),
    "forearm": (D, 3, -70.0 * UM, "d(A)"),
    "elbow": (A, 2, 50.0 * UM, "a(B1,A)"),
    "along parallel joints": (D, 2, 60.0 * UM, "d(B,B1)"),
    "twist": (ALPHA, 2, 60.0 * URAD, "alpha(B1,A)"),
}


def flange(q):
    T = np.eye(4)
    for angle, a, al, d, th in zip(q, A, ALPHA, D, THETA, strict=True):
        c, s, ca, sa = np.cos(angle + th), np.sin(angle + th), np.cos(al), np.sin(al)
        step = [[c, -s * ca, s * sa, a * c], [s, c * ca, -c * sa, a * s], [0, sa, ca, d]]
        T = T @ np.array([*step, [0, 0, 0, 1]], dtype=float)
    return T


@pytest.fixture(scope="module")
def learnt(tmp_path_factory):
    """A function: what is planted -> the arm fitted; the tracker stands anywhere."""
    folder = tmp_path_factory.mktemp("arm")
    table = np.column_stack([A, ALPHA / DEG, D, THETA / DEG]).tolist()
    lines = ["a,alpha,d,theta", *(",".join(map(str, row)) for row in table)]
    (folder / "dh.csv").write_text("\n".join(lines))
    q = np.random.default_rng(5).uniform(-1.3, 1.3, (POSES, 6))

    def made(array=None, index=0, step=0.0, chain=None, sag=0.0):
        if array is not None:
            array[index] += step
        own = q * [1, 1, 0, 0, 0, 0] if sag else q  # of two joints alone
        stood = own + sag * np.sin(own) * [0, 1, 0, 0, 0, 0]
        seen = np.array([(flange(row) @ REFLECTOR)[:3] for row in stood])
        if array is not None:
            array[index] -= step
        turn = np.array([[0.0, -1.0, 0.0], [1.0, 0.0, 0.0], [0.0, 0.0, 1.0]])
        rows = np.column_stack([own / DEG, seen @ turn.T + [900.0, 4000.0, -700.0]])
        head = ",".join([*(f"j{i}" for i in range(1, 7)), "x", "y", "z"])
        text = "\n".join([head, *(",".join(f"{v:.9f}" for v in row) for row in rows)])
        (folder / "log.csv").write_text(text)
        sheet = read_sheet(folder / "log.csv")
        table = read_arm(sheet)
        chain = chain or arm_from_dh(read_sheet(folder / "dh.csv"), table.q)[0]
        return fit_run(tracker_run(table, chain, 0.2 * UM), ordinary_model(chain))

    return made


@pytest.mark.parametrize("name", PLANTED)
def test_what_is_wrong_with_an_arm_is_reported_in_its_terms(learnt, name) -> None:
    array, index, step, symbol = PLANTED[name]
    rows = {r.symbol: r for r in geometry_rows(learnt(array, index, step))}
    found = rows[symbol]
    assert found.is_determined
    assert found.estimate.value == pytest.approx(step, rel=0.03)
    for other in rows.values():  # and nothing else is
        if "0" in other.symbol or other.symbol[0] != "E":
            wrong = other.symbol != symbol and other.is_determined
            assert not wrong or abs(other.estimate.value) < max(
                0.1 * abs(step), 4 * other.estimate.u
            )


@pytest.mark.parametrize("name", ["wrist zero", "upper arm", "twist"])
def test_all_lines_together_make_the_machine_file_of_the_arm_that_was_measured(
    learnt, name
) -> None:
    """Ten times the error, planted in the table: 5 % of it is left with the file alone."""
    array, index, step, _ = PLANTED[name]
    arm = found_arm(learnt(array, index, 10.0 * step))
    assert arm is not None
    again = learnt(array, index, 10.0 * step, arm.chain)
    left = fit_run(again.run, Model(arm.chain, ())).rms
    assert left < 0.05 * arm.before
    assert abs(left - arm.after) < 0.02 * arm.before


def test_lines_to_copy_hold_no_share_of_what_a_machine_file_cannot_hold(learnt) -> None:
    """A joint that sags, seen while two joints move: lines alone do what lines can, no harm."""
    fit = learnt(sag=2e-3)
    arm = found_arm(fit)
    assert arm is not None
    assert noticed(What.JOINTS_STOOD, names=("B1", "A", "B2", "A1")) in remarks(fit)
    again = fit_run(learnt(sag=2e-3, chain=arm.chain).run, Model(arm.chain, ())).rms
    assert max(again, arm.after) < 0.9 * arm.before


def test_names_of_arms_are_words(learnt) -> None:
    rows = {r.symbol: r for r in geometry_rows(learnt())}
    assert quantity_name(rows["EB0B1"]) == "zero of joint B1 (EB0B1)"
    assert quantity_name(rows["a(B,B1)"]) == "length of the link from B to B1 (a(B,B1))"
    assert quantity_name(rows["d(B,B1)"]) == "length along the line of B and B1 (d(B,B1))"
