"""The point that is moved through a chain, against products of scipy's rotations, pose by pose."""

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from matstd.twin.machine import Axis, Contribution, exact_tip, make_chain, moved_point, tip
from matstd.twin.units import NM

POSES, LENGTH = 40, 160.0
TRAVEL, TURN = Axis(range=(-400.0, 400.0)), (-3.0, 3.0)
CHAIN = make_chain(
    "oracle",
    "[w C' B' X' f Y Z (C1) t]",
    {
        **dict.fromkeys("YZ", TRAVEL),
        "X": Axis(range=(-400.0, 400.0), direction=(1.0, 0.02, -0.01), point=(5.0, 6.0, 7.0)),
        "B": Axis(range=TURN, point=(10.0, -20.0, -420.0), direction=(0.1, -1.0, 0.2)),
        "C": Axis(range=TURN, point=(3.0, 4.0, 5.0)),
    },
    table_origin=(1.0, 2.0, -500.0),
)


def turned(r, v):
    return Rotation.from_rotvec(r).apply(v)


def in_machine(link, six):
    """Errors of an axis are stated about its line: its frame by scipy's best rotation."""
    if link.kind == "fixed":
        return six[:3], six[3:]
    letter, sense = np.eye(3)[link.own], np.sign(link.direction[link.own])
    lean, _ = Rotation.align_vectors([sense * link.direction], [letter])
    own = np.where(letter == 1.0, sense, 1.0)  # that of its letter counts with the reading
    return lean.apply(six[:3] * own), lean.apply(six[3:] * own)


def by_products(q, twist, place):
    """One tool point; a displaced line is there and back again around the nominal motion."""
    x = np.array([0.0, 0.0, -LENGTH])
    links = list(enumerate(CHAIN.links))
    tool = [pair for pair in links if not pair[1].carries_workpiece]
    workpiece = [pair for pair in links if pair[1].carries_workpiece]

    def error(i, link, reading, x):
        e, r = in_machine(link, twist[i])
        sign = -1.0 if link.carries_workpiece else 1.0
        lever = link.point + (sign * reading * link.direction if link.kind == "linear" else 0.0)
        return lever + turned(r, x - lever) + e

    def motion(i, link, reading, x):
        """Forth on the tool's side, back on the workpiece's: plus the reading on both."""
        six, zero = place[i].copy(), 0.0
        if link.kind == "rotary":  # the zero of the reading tilts no line
            zero, six[3 + link.own] = six[3 + link.own], 0.0
        e, r = in_machine(link, six)
        if link.kind == "fixed" and link.carries_workpiece:
            return link.point + turned(-r, x - e - link.point)
        if link.kind == "fixed":
            return link.point + turned(r, x - link.point) + e
        if link.kind == "linear":
            return x + (reading + six[link.own]) * turned(r, link.direction)
        angle = reading + zero
        x = link.point + turned(-r, x - e - link.point)
        x = link.point + turned(angle * link.direction, x - link.point)
        return link.point + turned(r, x - link.point) + e

    def reading(link):
        return 0.0 if link.kind == "fixed" else q[CHAIN.axis_index(link.name)]

    for i, link in tool[::-1]:
        x = error(i, link, reading(link), motion(i, link, reading(link), x))
    for i, link in workpiece[::-1]:
        x = motion(i, link, reading(link), error(i, link, reading(link), x))
    return x - CHAIN.table_origin


@pytest.mark.parametrize("angle", [1e-9, 3e-5, 5e-3, 0.4])
@pytest.mark.parametrize("varies", [False, True])
@pytest.mark.parametrize("block", [7, 5000])
def test_exact_points(angle, varies, block, monkeypatch):
    rng = np.random.default_rng(4)
    low, high = np.array([CHAIN.link(name).range for name in CHAIN.axes]).T
    q = rng.uniform(low, high, (POSES, len(CHAIN.axes)))
    added = Contribution.zeros(POSES, len(CHAIN.links))
    for part in (added.twist, added.place):
        size = np.array([0.5] * 3 + [angle] * 3)
        rows = POSES if varies else 1
        part[:] = rng.normal(size=(rows, len(CHAIN.links), 6)) * size
    monkeypatch.setattr(moved_point, "_POSES_A_BLOCK", block)
    expected = [by_products(*row) for row in zip(q, added.twist, added.place, strict=True)]
    found = exact_tip(CHAIN, q, LENGTH, added)
    # a point 1 m away is turned some twenty times: as many last digits
    np.testing.assert_allclose(found, expected, rtol=20 * np.finfo(float).eps, atol=1e-6 * NM)
    nothing = np.zeros((len(CHAIN.links), 6))
    expected = [by_products(row, nothing, nothing) for row in q]
    np.testing.assert_allclose(tip(CHAIN, q, LENGTH), expected, rtol=0.0, atol=1e-6 * NM)
