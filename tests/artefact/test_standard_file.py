"""`standard.toml`: the same numbers after a round trip, one line for whatever is wrong in it."""

from dataclasses import fields, replace

import numpy as np
import pytest

from matstd.artefact.body import (
    ErrorShare,
    Known,
    KnownFeature,
    Verdict,
    read_standard,
    write_standard,
)
from matstd.artefact.body.known_file import KnownTable, known_table
from matstd.artefact.body.sag import Sag
from matstd.twin.errors import BadFile, DesignError


def equal(one, other):
    """Bit for bit, through tuples, arrays and dataclasses."""
    if isinstance(one, np.ndarray):
        return np.array_equal(one, other)
    if isinstance(one, tuple):
        return len(one) == len(other) and all(map(equal, one, other))
    if hasattr(one, "__dataclass_fields__"):
        return all(equal(getattr(one, f.name), getattr(other, f.name)) for f in fields(one))
    return one == other


def test_round_trip_keeps_every_bit(standard, tmp_path):
    shares = (ErrorShare("EXX", 1.0 / 3.0), ErrorShare("EC0Y", 0.1 + 0.2))
    first = replace(standard.patches[0], errors=shares)
    whole = replace(standard, serial="0001", patches=(first, *standard.patches[1:]))
    write_standard(tmp_path / "standard.toml", whole)
    again = read_standard(tmp_path / "standard.toml")
    assert equal(whole, again)
    assert not equal(whole, standard)
    write_standard(tmp_path / "twice.toml", again)
    assert (tmp_path / "twice.toml").read_bytes() == (tmp_path / "standard.toml").read_bytes()


def test_surface_of_the_file_is_the_surface_of_the_design(standard, tmp_path):
    write_standard(tmp_path / "standard.toml", standard)
    again = read_standard(tmp_path / "standard.toml")
    for patch, copy in zip(standard.patches, again.patches, strict=True):
        assert np.array_equal(patch.point(patch.grid()), copy.point(copy.grid()))


def test_file_is_written_whole_or_not_at_all(standard, tmp_path, monkeypatch):
    path = tmp_path / "standard.toml"
    write_standard(path, standard)
    before = path.read_bytes()

    def broken(self, target):
        raise OSError("disk full")

    monkeypatch.setattr("pathlib.Path.replace", broken)
    with pytest.raises(DesignError, match=r"cannot be written \(disk full\)"):
        write_standard(path, replace(standard, name="another"))
    assert path.read_bytes() == before
    assert [p.name for p in tmp_path.iterdir()] == ["standard.toml"]


def text_of(standard, tmp_path):
    write_standard(tmp_path / "good.toml", standard)
    return (tmp_path / "good.toml").read_text()


@pytest.mark.parametrize(
    ("old", "new", "where"),
    [
        (
            'format = "standard/1"',
            'format = "standard/2"',
            r'format: found .*expected "standard/1"',
        ),
        ('serial = ""', 'serial = ""\ncolour = "blue"', "colour: found an unknown key"),
        ("thickness_mm = 30.0", "thickness_mm = -30.0", r"base\.thickness_mm: found -30\.0"),
        ("modulus_MPa = 200000.0", "modulus_MPa = 1.21e6", r"material\.modulus_MPa: found 1210000"),
        ("modulus_MPa = 200000.0", "modulus_MPa = 0.99e3", r"material\.modulus_MPa: found 990"),
        ("thickness_mm = 30.0", "thickness_mm = nan", r"base\.thickness_mm: found nan"),
        ("thickness_mm = 30.0", 'thickness_mm = "30"', r"base\.thickness_mm: found '30'"),
        (
            "thickness_mm = 30.0\n",
            "",
            r"base\.thickness_mm: found nothing, expected a number above 0 mm",
        ),
        (
            "corner_radius_mm = 25.0",
            "corner_radius_mm = 150.0",
            "at most the smaller half side 140",
        ),
        ('name = "FF2"', 'name = "FF1"', "two features are named FF1"),
        ('name = "FF2"', 'name = "FF 2"', r"patch\.1\.name: found 'FF 2'"),
        ("    5,\n    5,\n", "    4,\n    5,\n", r"patch\.0: found FF1: knots_u: shape \(14,\)"),
        ("\nradius_mm = 5.5", "\nradius_mm = 9.5", r"hole\.0: found HOLE1: hole radius 9\.5 mm"),
        ("radius_mm = 12.5", "radius_mm = 2.5", r"sphere\.0: found SPH1: stem radius 6 mm"),
    ],
)
def test_whatever_is_wrong_is_one_line_with_file_and_key(standard, tmp_path, old, new, where):
    text = text_of(standard, tmp_path)
    assert old in text
    path = tmp_path / "bad.toml"
    path.write_text(text.replace(old, new, 1))
    with pytest.raises(BadFile, match=where) as caught:
        read_standard(path)
    assert str(caught.value).startswith(f"{path}: ")
    assert "\n" not in str(caught.value)


def test_a_mirror_is_no_rotation(standard, tmp_path):
    path = tmp_path / "bad.toml"
    T = standard.patches[0].T_artefact_patch.copy()
    T[:3, 0] *= -1.0
    mirrored = replace(standard.patches[0], T_artefact_patch=T)
    write_standard(path, replace(standard, patches=(mirrored, *standard.patches[1:])))
    with pytest.raises(BadFile, match=r"patch\.0\.rotation: .*right-handed rotation matrix"):
        read_standard(path)


def test_missing_and_cut_off_files(standard, tmp_path):
    with pytest.raises(BadFile, match=r"none\.toml: file: found no such file"):
        read_standard(tmp_path / "none.toml")
    cut = tmp_path / "cut.toml"
    cut.write_text(text_of(standard, tmp_path)[:5000])
    with pytest.raises(BadFile, match="whole TOML file"):
        read_standard(cut)


@pytest.mark.parametrize("temperature", [15.0, 30.0])
def test_a_warm_standard_is_larger_in_every_length(standard, temperature):
    """Every surface point moves away from the origin by 10.5e-6 a kelvin, normals stay."""
    warm, k = standard.at(temperature), 1.0 + 10.5e-6 * (temperature - 20.0)
    for name, surface in standard.features.items():
        uv = np.array([[0.1, 0.2], [-0.7, 0.4], [1.0, 1.1]])
        at = uv if name.startswith("SPH") else k * uv  # angles of a ball, lengths of a face
        grown = warm.features[name]
        np.testing.assert_allclose(grown.point(at), k * surface.point(uv), rtol=0.0, atol=1e-10)
        np.testing.assert_allclose(grown.normal(at), surface.normal(uv), rtol=0.0, atol=1e-12)
    assert [s.radius for s in warm.spheres] == [k * s.radius for s in standard.spheres]


def test_the_uncertainty_of_the_expansion_is_kept(standard, tmp_path):
    known = replace(standard, material=replace(standard.material, u_expansion=3e-7))
    write_standard(tmp_path / "standard.toml", known)
    assert "expansion_u_1_K = 3e-07" in (tmp_path / "standard.toml").read_text(encoding="utf-8")
    assert equal(known, read_standard(tmp_path / "standard.toml"))
    text = (tmp_path / "standard.toml").read_text(encoding="utf-8")
    (tmp_path / "bad.toml").write_text(text.replace("1.05e-05", "11.5"), encoding="utf-8")
    with pytest.raises(BadFile, match=r"material.expansion_1_K: found 11.5"):
        read_standard(tmp_path / "bad.toml")


def test_a_calibration_is_written_to_the_digits_of_its_units():
    """Tenths of a nanometre, nanoradians: by hand, and read in base units again."""
    axes = (1.23456e-4, 2.34567e-4, 3.45678e-4)
    features = {
        "FF1": KnownFeature(49, 4.56789e-4, 5.67891e-6, 6.78912e-4),
        "SPH1": KnownFeature(25, 7.89123e-4, 0.0, 0.0, axes),
    }
    verdicts = (
        Verdict("SPH1", "diameter", -1.23456e-3, 2.34567e-3, 1.11116e-4),
        Verdict("FF1", "profile", 5.43216e-3, 4.32156e-3, 2.22226e-4),
    )
    table = known_table(Known("cmm.csv", "0123", features, verdicts, 1.23456e-6))
    assert table == {
        "source": "cmm.csv",
        "nominal": "0123",
        "scale_u_ppm": 1.2346,
        "feature": {
            "FF1": {"points": 49, "u_um": 0.4568, "u_urad": 5.679, "u_form_um": 0.6789},
            "SPH1": {"points": 25, "u_um": 0.7891, "u_urad": 0.0, "u_form_um": 0.0,
                     "u_axes_um": [0.1235, 0.2346, 0.3457]},
        },
        "verdict": [
            {"feature": "SPH1", "characteristic": "diameter", "deviation_um": -1.2346,
             "tolerance_um": 2.3457, "u_um": 0.1111, "verdict": "conforming"},
            {"feature": "FF1", "characteristic": "profile", "deviation_um": 5.4322,
             "tolerance_um": 4.3216, "u_um": 0.2222, "verdict": "not conforming, accepted"},
        ],
    }  # fmt: skip
    again = KnownTable.model_validate(table).known()
    assert again.u_scale == pytest.approx(1.2346e-6)
    assert again.features["SPH1"].u_axes == pytest.approx((1.235e-4, 2.346e-4, 3.457e-4))
    found = [f for f in again.features.values()]
    assert [f.points for f in found] == [49, 25]
    assert [f.u for f in found] == pytest.approx([4.568e-4, 7.891e-4])
    assert found[0].u_tilt == pytest.approx(5.679e-6)
    assert found[0].u_form == pytest.approx(6.789e-4)
    read = [(v.deviation, v.tolerance, v.u) for v in again.verdicts]
    np.testing.assert_allclose(
        read, [(-1.2346e-3, 2.3457e-3, 1.111e-4), (5.4322e-3, 4.3216e-3, 2.222e-4)]
    )


def test_a_sag_of_a_feature_that_there_is_not_is_refused(standard, tmp_path):
    sag = Sag("measured", "-Z", 0.1, {"FF1": np.diag([0.0, 0.0, 0.002])})
    text = text_of(replace(standard, sag=sag), tmp_path)
    found = read_standard(tmp_path / "good.toml").sag.per_weight["FF1"]
    np.testing.assert_allclose(found, np.diag([0.0, 0.0, 0.002]), atol=1e-9)
    head, there, tail = text.partition("[sag")
    path = tmp_path / "bad.toml"
    path.write_text(head + there + tail.replace("FF1", "NONE"))
    with pytest.raises(BadFile, match=r"sag\.um\.NONE: found NONE, expected one of FF1"):
        read_standard(path)
