"""Weight bends a standard as it is turned: directions, signs, and what an evaluation takes off."""

from dataclasses import replace

import numpy as np
import pytest

from matstd.artefact.body import Material, read_standard, write_standard
from matstd.artefact.body.sag import Sag, weight_directions
from matstd.probe_paths.campaign import VirtualMachine, evaluate, simulate
from matstd.twin.errors import BadFile
from matstd.twin.frames import fixed_xyz, pose
from matstd.twin.machine import Axis, make_chain
from matstd.twin.units import DEG, NM, UM

TRAVEL = {n: Axis(range=(-400.0, 400.0)) for n in "XYZ"}
TURNS = {n: Axis((-7.0, 7.0), (0.0, 0.0, 0.0)) for n in "BC"}
HERE = np.eye(4)


@pytest.fixture(scope="module")
def tilting():
    """A table that turns on a cradle: B' tilts what C' turns."""
    return make_chain("tilting", "[w C' B' X' f Y Z t]", TRAVEL | TURNS, (0.0, 0.0, -400.0))


def readings(chain, **degrees):
    q = np.zeros((1, len(chain.axes)))
    for name, value in degrees.items():
        q[0, chain.axis_index(name)] = value * DEG
    return q


def test_an_upright_standard_is_pulled_into_its_seat_however_the_table_turns(tilting):
    for c in (0.0, 33.0, -90.0):
        down = weight_directions(tilting, readings(tilting, C=c), HERE, "-Z")
        np.testing.assert_allclose(down, [[0.0, 0.0, -1.0]], atol=1e-15)


def test_a_table_tilted_by_ninety_degrees_lets_a_standard_lie_on_its_side(tilting):
    # B' is an axis of the workpiece: at +90 the table has turned by -90 about +y (ISO 841), so the
    # standard's own z looks to -x of the machine, its x to +z: weight pulls along its -x
    down = weight_directions(tilting, readings(tilting, B=90.0), HERE, "-Z")
    np.testing.assert_allclose(down, [[-1.0, 0.0, 0.0]], atol=1e-15)
    down = weight_directions(tilting, readings(tilting, B=90.0, C=90.0), HERE, "-Z")
    assert abs(down[0, 1]) == pytest.approx(1.0)
    # a standard that is clamped upside down, and a machine whose spindle lies
    over = pose(fixed_xyz(np.array([np.pi, 0.0, 0.0])), np.zeros(3))
    assert weight_directions(tilting, readings(tilting), over, "-Z")[0, 2] == pytest.approx(1.0)
    aside = weight_directions(tilting, readings(tilting), HERE, "-Y")
    np.testing.assert_allclose(aside, [[0.0, -1.0, 0.0]], atol=1e-15)


def test_a_soft_post_gives_way_downwards(tilting):
    soft = Sag("test", "-Z", 0.2, {"SPH1": np.diag([0.5, 0.4, 0.1]) * UM})
    names = np.array(["SPH1"])
    lying = soft.moved(tilting, readings(tilting, B=90.0), HERE, names)
    # along its own -x, which looks down now; and up from where its weight had pressed it
    np.testing.assert_allclose(lying / UM, [[-0.5, 0.0, 0.1]], atol=1e-12)
    upright = soft.moved(tilting, readings(tilting, C=50.0), HERE, names)
    np.testing.assert_allclose(upright, 0.0, atol=1e-18)
    assert not soft.moved(tilting, readings(tilting, B=90.0), HERE, np.array(["FF1"])).any()


def test_an_evaluation_takes_off_what_a_standard_sags(programs, small, plan, tmp_path):
    """Against rotations by hand; the set-up, which is fitted, takes up its part of what is left."""
    rng = np.random.default_rng(5)
    names = [*(p.name for p in small.patches), *(s.name for s in small.spheres)]
    sag = Sag("test", "-Z", 0.2, {name: rng.normal(size=(3, 3)) * UM for name in names})
    sagging, chain = replace(small, sag=sag), plan.chain
    paths = programs.write(tmp_path)
    done = simulate(paths, sagging, VirtualMachine(chain), rng, calibrated=small)
    seen, u = done.run, 1.0 * UM
    taken = evaluate(done.parts, sagging, chain, u)
    assert np.abs(taken.deviation).max() < NM
    t = taken.touches
    moved = np.empty((len(t), 3))
    for i, (b, c) in enumerate(t.q[:, [chain.axis_index(a) for a in "BC"]]):
        about_z = np.array([[np.cos(c), -np.sin(c), 0], [np.sin(c), np.cos(c), 0], [0, 0, 1]])
        about_y = np.array([[np.cos(b), 0, np.sin(b)], [0, 1, 0], [-np.sin(b), 0, np.cos(b)]])
        pulled = t.T_table_artefact[i, :3, :3].T @ about_z @ about_y @ [0.0, 0.0, -1.0]
        moved[i] = sag.per_weight[str(t.feature[i])] @ (pulled - [0.0, 0.0, -1.0])
    along = np.einsum("ni,ni->n", t.normal, moved)
    assert np.sqrt(np.mean(along**2)) > 0.3 * UM
    placed = np.concatenate([t.normal, np.cross(t.point, t.normal) / 100.0], axis=1)
    left = seen.deviation - along
    left -= placed @ np.linalg.lstsq(placed, left, rcond=None)[0]
    assert np.abs(left).max() < 5.0 * NM
    np.testing.assert_allclose(taken.u, np.hypot(u, 0.2 * along), rtol=1e-3)
    assert any("sag of the standard taken off" in remark for remark in taken.remarks)
    assert not any("sag" in remark for remark in seen.remarks)


def test_the_file_keeps_it_and_refuses_what_it_cannot_be(upright, tmp_path):
    path = tmp_path / "standard.toml"
    sag = Sag("by hand", "-Y", 0.25, {"SPH1": np.array([[1.0, 2, 3], [4, 5, 6], [7, 8, 9]]) * UM})
    write_standard(path, replace(upright, sag=sag))
    found = read_standard(path).sag
    assert (found.source, found.down, found.share) == ("by hand", "-Y", 0.25)
    np.testing.assert_allclose(found.per_weight["SPH1"], sag.per_weight["SPH1"], rtol=1e-12)
    text = path.read_text()
    for old, new, words in (
        ("SPH1 = [\n", "SPH9 = [\n", "sag.um.SPH9"),
        ('down = "-Y"', 'down = "Y"', "sag.down"),
        ("share = 0.25", "share = -1.0", "sag.share"),
    ):
        assert old in text
        path.write_text(text.replace(old, new))
        with pytest.raises(BadFile, match=words):
            read_standard(path)


OLD = """
[sag]
source = "finite elements"
down = "-Z"
share = 0.2
um.SPH1 = [[0.5, 0.0, 0.0], [0.0, 0.5, 0.0], [0.0, 0.0, 0.1]]
"""


@pytest.mark.parametrize(
    ("modulus", "moved", "output"),
    [
        (None, 0.0, "not taken off: no modulus is stated of '1.2379'; state material.modulus_MPa"),
        (200000.0, 0.5, "taken off: finite elements with 200 GPa (stated), weight along -Z"),
        (71000.0, 0.5 * 200.0 / 71.0, "taken off: finite elements with 71 GPa (stated)"),
    ],
)
def test_a_sag_of_earlier_versions_was_made_for_steel(
    programs, small, plan, tilting, tmp_path, modulus, moved, output
):
    """Their files have no modulus: with one the displacements go by its reciprocal."""
    path = tmp_path / "standard.toml"
    write_standard(path, replace(small, material=Material("1.2379", 7.7e-6, 11e-6)))
    text = path.read_text()
    assert "modulus" not in text
    if modulus:
        text = text.replace("expansion_1_K", f"modulus_MPa = {modulus}\nexpansion_1_K")
    path.write_text(text + OLD)
    standard = read_standard(path)
    lying = standard.moved(tilting, readings(tilting, B=90.0), HERE, np.array(["SPH1"]))
    np.testing.assert_allclose(lying[0] / UM, [-moved, 0.0, moved / 5.0], atol=1e-12)
    # what is written again says the same
    write_standard(path, standard)
    again = read_standard(path).moved(tilting, readings(tilting, B=90.0), HERE, np.array(["SPH1"]))
    np.testing.assert_array_equal(again, lying)
    rng, machine = np.random.default_rng(5), VirtualMachine(plan.chain)
    done = simulate(programs.write(tmp_path / "p"), small, machine, rng, calibrated=small)
    run = evaluate(done.parts, standard, plan.chain, 1.0 * UM)
    assert [r for r in run.remarks if f"sag of the standard {output}" in r]
    assert len([r for r in run.remarks if "sag" in r]) == 1


def test_a_measured_sag_rests_on_no_modulus(small, tilting):
    sag = Sag("measured on a tilting table", "-Z", 0.05, {"SPH1": np.eye(3) * UM})
    own = replace(small, sag=sag, material=Material("1.2379", 7.7e-6, 11e-6))
    lying = own.moved(tilting, readings(tilting, B=90.0), HERE, np.array(["SPH1"]))
    np.testing.assert_allclose(lying[0] / UM, [-1.0, 0.0, 1.0], atol=1e-12)
