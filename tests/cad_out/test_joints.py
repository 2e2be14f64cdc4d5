"""Studs and blocks of a standard that is made of parts: places, threads, volumes by hand."""

from dataclasses import replace

import demo
import numpy as np
import pytest

from matstd.artefact.body import graph_patch
from matstd.cad_out.details import details_of
from matstd.cad_out.making import PAD_HEIGHT, joints_of
from matstd.twin.errors import NotBuildable


def test_threads_stay_in_the_material(upright):
    details = details_of(upright)
    joints = joints_of(upright, details)
    thick = upright.base.thickness
    assert [stud.ball for stud in joints.studs] == [ball.name for ball in upright.spheres]
    for stud, ball in zip(joints.studs, upright.spheres, strict=True):
        assert stud.thread < 1.31 * ball.foot_radius  # what is left of the foot is its shoulder
        assert stud.thread <= stud.depth <= thick - 3.0
    for block, patch in zip(joints.blocks, upright.patches, strict=True):
        local = block.places - patch.T_artefact_patch[:2, 3]
        turn = np.sort(np.arctan2(local[:, 1], local[:, 0]))
        assert np.diff(turn) == pytest.approx(np.deg2rad(120.0), abs=0.05)
        grid = patch.grid(0.5)
        over = patch.point(grid)
        for place in local:
            near = np.hypot(*(grid - place).T) <= 0.5 * block.thread
            assert over[near, 2].min() >= block.depth + 2.9
        # in the block no farther than the hole, and more than its diameter
        assert block.thread < block.sunk + block.length - thick < block.depth - thick
        assert block.thread + 1.0 < block.sunk <= thick - 8.0


def test_pads_end_before_the_edge_of_their_block(upright):
    """Places are rounded to 0.1 mm: a pad that would end within 0.05 mm of the edge touches it."""
    details, (first, *_) = details_of(upright), upright.patches
    for half in np.arange(14.0, 17.0, 0.1).round(1):
        size, low = (half, half + 0.5), first.T_artefact_patch[2, 3] - 8.0
        patch = graph_patch("FF1", first.T_artefact_patch, size, demo.waves(1, 1.0), (5, 5), low)
        (block,) = joints_of(replace(upright, patches=(patch,)), details).blocks
        local = block.places - patch.T_artefact_patch[:2, 3]
        assert (np.abs(local) + block.pad < np.array(size) - 0.1).all()


def test_holes_from_below_miss_pads_and_bores(upright):
    details = details_of(upright)
    joints = joints_of(upright, details)
    for block in joints.blocks:
        for x, y in block.places:
            for pad in details.pads:
                assert np.hypot(x - pad.x, y - pad.y) > pad.radius + 0.5 * block.head
            for bore in details.bores:
                on = np.linspace(0.0, bore.depth, 60)[:, None] * np.array(bore.direction[:2])
                apart = np.hypot(*(np.array(bore.mouth[:2]) + on - [x, y]).T).min()
                assert apart > bore.radius + 0.5 * block.head


def test_leaning_faces_and_thin_plates_have_no_joints(standard, upright):
    with pytest.raises(NotBuildable, match="a face leans"):
        joints_of(standard, details_of(standard))
    low = [replace(p, heights=p.heights - p.heights.max() - 40.0) for p in upright.patches]
    with pytest.raises(NotBuildable, match="no room for three screws under FF1"):
        joints_of(replace(upright, patches=tuple(low)), details_of(upright))


def test_parts_have_the_volumes_of_their_formulas(upright):
    from matstd.cad_out.kernel.parts import parts_of

    details = details_of(upright)
    joints = joints_of(upright, details)
    made = {part.name: part for part in parts_of(upright, details, joints, ())}
    assert len(made) == 1 + len(upright.spheres) + 2 * len(upright.patches)  # screws of each block
    stud, ball = joints.studs[0], upright.spheres[0]
    seat, a = details.seats[ball.name], ball.foot_radius
    b, tall = seat.top_radius, seat.top - ball.foot
    cone = np.pi * tall / 3.0 * (a * a + a * b + b * b)
    sink = np.pi * seat.rim_radius**2 * (seat.top - seat.bottom) / 3.0
    thread = np.pi * (0.5 * stud.core) ** 2 * stud.depth
    assert made[f"{ball.name} STUD"].volume == pytest.approx(cone - sink + thread, rel=1e-9)
    block, patch = joints.blocks[0], upright.patches[0]
    (wide, long), thick = patch.half_size, upright.base.thickness
    x, w = np.polynomial.legendre.leggauss(40)
    uv = np.stack(np.meshgrid(wide * x, long * x, indexing="ij"), axis=-1).reshape(-1, 2)
    z = patch.point(uv)[:, 2] - thick
    pillar = wide * long * np.outer(w, w).reshape(-1) @ z
    gap = PAD_HEIGHT * (4.0 * wide * long - 3.0 * np.pi * block.pad**2)
    holes = 3.0 * np.pi * (0.5 * block.core) ** 2 * (block.depth - thick)
    assert made[f"{patch.name} BLOCK"].volume == pytest.approx(pillar - gap - holes, rel=1e-5)
