"""Tables of controls: hand-worked values, what is left, refusals, the test of the sign."""

from dataclasses import replace

import numpy as np
import pytest
from bench import LENGTH, oracle_tip, truth

from matstd.cli import main
from matstd.compensation.field import (
    MachineErrors,
    State,
    UncorrectedError,
    aligned,
    datum_of,
    deviation,
    deviation_after,
    sample_workspace,
)
from matstd.compensation.field.over_workspace import _as_determined
from matstd.compensation.tables import (
    FORMATS,
    Harmful,
    Header,
    header_of,
    refuse_harmful,
    verify_tables,
    write_tables,
)
from matstd.compensation.tables.along_axes import along_axes
from matstd.compensation.tables.by_name import interpolated, line
from matstd.diagnosis.geometry import Estimate
from matstd.report.compensation import grown_sentence, table_lines
from matstd.twin.errors import BadFile
from matstd.twin.files import read_machine
from matstd.twin.library import parse_effect
from matstd.twin.machine import Axis, exact_tip, make_chain, tip
from matstd.twin.numbers import rms_length as rms
from matstd.twin.units import DEG, NM, UM, URAD


@pytest.fixture(scope="module")
def written(known, datum, head, poses, tmp_path_factory):
    """Folders of all formats."""
    folder = tmp_path_factory.mktemp("tables")
    for name, form in FORMATS.items():
        write_tables(form, folder / name, known, datum, head, poses)
    return folder


@pytest.fixture(scope="module")
def results(known, datum, head, written, poses):
    return {
        name: verify_tables(form, written / name, known, datum, head, poses)
        for name, form in FORMATS.items()
    }


def only(chain, name, amplitude):
    return MachineErrors.of_errors(chain, [(parse_effect(name, chain), np.array([amplitude]))])


def columns(path, first):
    """Rows of numbers of a file below the line that begins with some word."""
    lines = path.read_text().splitlines()
    start = next(i for i, text in enumerate(lines) if text.startswith(first)) + 1
    rows = []
    for text in lines[start:]:
        try:
            rows.append([float(word) for word in text.split()])
        except ValueError:
            break
    return np.array(rows)


# --- hand-worked values ---------------------------------------------------------------------


def test_iso_names_and_units(written):
    x = columns(written / "iso230" / "iso230.csv", "X EXX EYX EZX EAX EBX ECX")
    assert x[0, 0] == -400.0
    np.testing.assert_allclose(x[-1], [400, 0, 0, 0.020, 0, 60e-6, 0], atol=1e-9)
    at = np.flatnonzero(x[:, 0] == -300.0)[0]  # an eighth of the way: sin(2 pi 2/8) = 1
    np.testing.assert_allclose(x[at, 1], 0.030, atol=1e-7)
    text = (written / "iso230" / "iso230.csv").read_text().splitlines()
    place = dict(zip(text[-2].split(), map(float, text[-1].split()), strict=True))
    assert place["C0Y"] == 45e-6
    assert (place["X0C"], place["Z0B"], place["X0X"], place["A0C"]) == (0.025, 0.030, 0.015, 35e-6)
    c = columns(written / "iso230" / "iso230.csv", "C EXC")
    assert (c[0, 0], c[-1, 0]) == (0.0, 360.0)
    np.testing.assert_allclose(c[len(c) // 4, [1, 6]], [0.008, 30e-6], atol=1e-9)


def test_com_tables_have_the_error_of_each_axis(bench_chain, datum, head, poses, tmp_path):
    """EXX of 12 um at the ends, ECC of 30 urad at 90 degrees; nothing of reversal and EC0Y."""
    effects = [("geometric(EXX,linear)", 12 * UM), ("backlash(X)", 8 * UM)]
    effects += [("geometric(ECC,sinusoidal)", 30 * URAD), ("location(EC0Y)", 45 * URAD)]
    pairs = [(parse_effect(name, bench_chain), np.array([a])) for name, a in effects]
    errors = MachineErrors.of_errors(bench_chain, pairs)
    write_tables(FORMATS["heidenhain"], tmp_path, errors, datum, head, poses)
    assert {p.name for p in tmp_path.iterdir()} == {f"{axis}.COM" for axis in "XYZBC"}
    x = columns(tmp_path / "X.COM", "NR AXISPOS X")
    np.testing.assert_allclose(x[[0, -1], 1:], [[-400, -0.012], [400, 0.012]], atol=6e-5)
    c = columns(tmp_path / "C.COM", "NR AXISPOS C")
    at = np.flatnonzero(c[:, 1] == 90.0)[0]
    np.testing.assert_allclose(c[at, 2], 30e-6 / DEG, atol=1e-6)
    assert not columns(tmp_path / "Y.COM", "NR AXISPOS Y")[:, 2].any()  # EC0Y is in no .COM


def test_com_tables_are_credited_with_positioning_alone(bench_chain, datum, head, poses, tmp_path):
    """Of an axis's own error little is left, of its angles and of lines of rotary axes all."""
    for name, size, share in (
        ("geometric(EXX,linear)", 30 * UM, 0.01),
        ("geometric(EZX,2)", 20 * UM, 1.0),
        ("location(EA0C)", 35 * URAD, 1.0),
    ):
        effect = parse_effect(name, bench_chain)
        theta = np.full(len(effect.parameters), size)
        errors = MachineErrors.of_errors(bench_chain, [(effect, theta)])
        write_tables(FORMATS["heidenhain"], tmp_path, errors, datum, head, poses)
        found = verify_tables(FORMATS["heidenhain"], tmp_path, errors, datum, head, poses).result
        np.testing.assert_allclose(rms(found.after), share * rms(found.before), atol=0.2 * UM)


def test_comp_file_adds_what_the_axis_lacks_in_each_direction(
    bench_chain, datum, head, poses, tmp_path
):
    effects = [("geometric(EXX,linear)", 12 * UM), ("backlash(X)", 8 * UM)]
    pairs = [(parse_effect(name, bench_chain), np.array([a])) for name, a in effects]
    errors = MachineErrors.of_errors(bench_chain, pairs)
    write_tables(FORMATS["linuxcnc"], tmp_path, errors, datum, head, poses)
    x = columns(tmp_path / "X.comp", "# matstd sign")
    # coming from below the tool stands 4 µm too far, from above 4 µm short
    np.testing.assert_allclose(x[-1], [400, -0.012 - 0.004, -0.012 + 0.004], atol=1e-6)
    np.testing.assert_allclose(x[0], [-400, 0.012 - 0.004, 0.012 + 0.004], atol=1e-6)


def test_cec_corrects_across(bench_chain, datum, head, poses, tmp_path):
    """EC0Y moves the tool by -EC0Y y in X, so X is to move by +EC0Y y."""
    errors = only(bench_chain, "location(EC0Y)", 10 * URAD)
    write_tables(FORMATS["sinumerik"], tmp_path, errors, datum, head, poses)
    text = (tmp_path / "NC_CEC.INI").read_text()
    assert "$AN_CEC_INPUT_AXIS[0]=(Y)\n$AN_CEC_OUTPUT_AXIS[0]=(X)" in text
    tables, _ = FORMATS["sinumerik"].read(tmp_path, bench_chain)
    (table,) = tables.tables
    np.testing.assert_allclose(table.forward, 10e-6 * table.nodes, atol=1e-6)


def test_cec_writes_as_many_tables_as_a_control_holds(written, bench_chain):
    tables, _ = FORMATS["sinumerik"].read(written / "sinumerik", bench_chain)
    assert 5 <= len(tables.tables) <= 10
    text = (written / "sinumerik" / "NC_CEC.INI").read_text()
    assert "$AN_CEC_IS_MODULO" in text


# --- what is left ---------------------------------------------------------------------------


def test_tables_by_name_leave_their_interpolation(results):
    found = results["iso230"]
    worst = np.linalg.norm(found.result.after, axis=1).max()
    assert rms(found.result.before) > 30 * UM
    assert 0.0 < worst <= found.interpolation < 2 * UM


def test_between_and_beyond_its_points_a_table_reads_as_numpy_interpolates():
    nodes, at = np.array([-40.0, -10.0, 5.0, 60.0]), np.linspace(-70.0, 90.0, 33)
    values = np.array([[3.0, -1.0], [0.5, 4.0], [-2.0, 4.0], [1.0, 0.0]])
    expected = np.column_stack([np.interp(at, nodes, v) for v in values.T])
    np.testing.assert_allclose(interpolated(at, nodes, values), expected, atol=1e-12)


def test_every_parameter_adds_its_own_error(known):
    """Errors by their formulas; the two of a wave, beside another effect, as of the whole."""
    chain = known.chain  # C, B, X, Y, Z and the spindle
    q = np.array([[1.1, -0.4, 120.0, -80.0, -250.0, 0.0], [-2.0, 0.3, -200.0, 40.0, -90.0, 0.0]])
    by_axis = {axis: q[:, chain.axis_index(axis)] for axis in chain.axes}
    links = range(len(chain.links))
    added = known.amounts(known.touches(q, LENGTH), "twist", links) @ np.concatenate(known.theta)
    expected = np.zeros_like(added)
    for name, error in truth(by_axis).items():
        if "0" not in name:
            where = chain.twist_of(chain.symbol(name))
            expected[:, where.link, where.component] = error
    np.testing.assert_allclose(added, expected, atol=1e-9 * UM)
    wave = parse_effect("periodic(EXX)", chain), np.array([3.0, -4.0]) * UM  # sine and cosine
    two = MachineErrors.of_errors(
        chain, [wave, (parse_effect("backlash(X)", chain), np.array([2.0 * UM]))]
    )
    touches = two.touches(q, LENGTH)
    added = two.amounts(touches, "twist", links) @ np.concatenate(two.theta)
    assert np.abs(added[:, chain.link_index("X"), 0]).min() > UM
    np.testing.assert_allclose(added, two.contribution(touches).twist, atol=1e-9 * UM)


def test_unaligned_too(known, written, bench_chain, poses, results):
    """The rigid motion that alignment takes off hides nothing."""
    tables, _ = FORMATS["iso230"].read(written / "iso230", bench_chain)
    touches = known.touches(poses, LENGTH)
    left = deviation_after(known, touches, tables.correction(touches))
    assert np.linalg.norm(left, axis=1).max() <= results["iso230"].interpolation


def test_cec_is_exact_along_the_axes(known, datum, head, poses, bench_chain, tmp_path):
    linear = known.switched({"B": 0.0, "C": 0.0})
    write_tables(FORMATS["sinumerik"], tmp_path, linear, datum, head, poses)
    found = verify_tables(FORMATS["sinumerik"], tmp_path, linear, datum, head, poses)
    tables, _ = FORMATS["sinumerik"].read(tmp_path, bench_chain)
    there = linear.touches(datum.q[None], LENGTH)
    for axis in ("X", "Y", "Z"):
        at = np.linspace(*bench_chain.link(axis).range, 173)
        touches = line(linear, datum, axis, at)
        left = deviation_after(linear, touches, tables.correction(touches))
        left -= deviation_after(linear, there, tables.correction(there))
        # tables that help by less than 50 nm are not written
        assert np.linalg.norm(left, axis=1).max() <= found.interpolation + 100 * NM


def test_formats_hold_less_and_less(results):
    left = [
        rms(results[name].result.after)
        for name in ("iso230", "sinumerik", "linuxcnc", "heidenhain")
    ]
    assert left == sorted(left)
    assert left[1] < 0.5 * rms(results["sinumerik"].result.before)


@pytest.mark.parametrize("name", list(FORMATS))
@pytest.mark.parametrize(
    ("effect", "size"),
    [("coupling(EBX,Z)", 40 * URAD), ("location(EX0C)", 30 * UM), ("geometric(EZX,2)", 20 * UM)],
)
def test_what_is_left_of_one_error_is_what_is_played(
    bench_chain, datum, head, poses, tmp_path, name, effect, size
):
    """First order, all parameters at once, against the exact twin with tables of that error."""
    effect = parse_effect(effect, bench_chain)
    theta = np.full(len(effect.parameters), size)
    errors = MachineErrors.of_errors(bench_chain, [(effect, theta)])
    write_tables(FORMATS[name], tmp_path, errors, datum, head, poses)
    found = verify_tables(FORMATS[name], tmp_path, errors, datum, head, poses)
    (left,) = found.result.left
    np.testing.assert_allclose(left.rms, rms(found.result.after), atol=0.15 * UM)
    np.testing.assert_allclose(left.before, rms(found.result.before), rtol=1e-3)


def test_a_coupling_is_left_but_for_its_share_at_the_datum(
    bench_chain, datum, head, poses, tmp_path
):
    """EBX = a u_X u_Z: tables hold u_Z of the datum, so what is left grows with the distance."""
    errors = only(bench_chain, "coupling(EBX,Z)", 40 * URAD)
    write_tables(FORMATS["iso230"], tmp_path, errors, datum, head, poses)
    x = columns(tmp_path / "iso230.csv", "X EXX")
    u_datum = (-200.0 + 250.0) / 250.0
    np.testing.assert_allclose(x[-1, 5], 40e-6 * u_datum, atol=1e-9)


def played_by_oracle(path, chain, q):
    """Deviation with the `.comp` files of a folder, read and played by code of this test alone."""
    shift = np.zeros_like(q)
    for k, name in enumerate(chain.axes):
        file = path / f"{name}.comp"
        if not file.exists():
            continue
        rows = [r.split() for r in file.read_text().splitlines() if not r.startswith("#")]
        table = np.array(rows, dtype=float)
        unit = np.pi / 180.0 if name in "ABC" else 1.0
        added = table[:, 1:].mean(axis=1) * unit
        shift[:, k] = np.interp(q[:, k], table[:, 0] * unit, added)
    errs = [oracle_tip(q + s, chain) - oracle_tip(q, chain, False) for s in (0.0 * q, shift)]
    points = oracle_tip(q, chain, False)
    return [without_rigid_motion(points, e) for e in errs]


def without_rigid_motion(points, field):
    """A field less the small rigid motion that fits it best, by plain least squares."""
    p = points - points.mean(axis=0)
    turned = np.stack([np.cross(e, p) for e in np.eye(3)], axis=-1)  # (N, 3, 3)
    shifted = np.broadcast_to(np.eye(3), turned.shape)
    A = np.concatenate([shifted, turned], axis=-1).reshape(-1, 6)
    b = field.reshape(-1)
    return (b - A @ np.linalg.lstsq(A, b, rcond=None)[0]).reshape(-1, 3)


def test_comp_files_on_the_second_model(written, results, bench_chain, poses):
    before, after = played_by_oracle(written / "linuxcnc", bench_chain, poses)
    np.testing.assert_allclose(rms(before), rms(results["linuxcnc"].result.before), rtol=1e-3)
    np.testing.assert_allclose(rms(after), rms(results["linuxcnc"].result.after), rtol=1e-3)
    assert rms(after) < rms(before)


FORK = """format = "machine/1"
name = "fork"
chain = "[w f X Y Z C A t]"
[axis.X]
range = [0.0, 1000.0]
[axis.Y]
range = [0.0, 800.0]
[axis.Z]
range = [-600.0, 0.0]
[axis.C]
range = [-180.0, 180.0]
[axis.A]
range = [-100.0, 100.0]
point = [0.0, 0.0, -150.0]
"""


def test_the_joints_of_a_fork_head_are_corrected_from_their_datum_on(tmp_path):
    """What C and A do wrong at the datum displaces the head at every other angle, too."""
    (tmp_path / "fork.toml").write_text(FORK)
    chain = read_machine(tmp_path / "fork.toml")
    datum = datum_of(chain, {"X": 500.0, "Y": 400.0, "Z": -300.0}, 250.0)
    q = sample_workspace(chain, {}, 200)
    head = header_of(chain, "0123456789ab", datum, State())
    rotary = ["geometric(ECC,sinusoidal@90)", "geometric(EAA,sinusoidal@90)"]
    pairs = [(parse_effect(name, chain), np.array([400 * URAD])) for name in rotary]
    errors = MachineErrors.of_errors(chain, pairs)
    write_tables(FORMATS["linuxcnc"], tmp_path / "comp", errors, datum, head, q)
    found = verify_tables(FORMATS["linuxcnc"], tmp_path / "comp", errors, datum, head, q)
    assert rms(found.result.before) > 20 * UM
    assert rms(found.result.after) < 0.01 * rms(found.result.before)
    assert not found.left_out


def test_a_table_that_is_wrong_beside_its_datum_is_left_out(tmp_path):
    """With the tool far down, a pitch of X does more than its scale takes back in the middle."""
    path = tmp_path / "fork.toml"
    path.write_text(FORK)
    chain = read_machine(path)
    datum = datum_of(chain, {"X": 500.0, "Y": 400.0, "Z": -600.0}, 250.0)
    q = sample_workspace(chain, {}, 200)
    head = header_of(chain, "0123456789ab", datum, State())
    sizes = {"EBX,sinusoidal@90": 400 * URAD, "EXX,sinusoidal@90": 200 * UM, "EYY,linear": 40 * UM}
    pairs = [
        (parse_effect(f"geometric({name})", chain), np.array([a])) for name, a in sizes.items()
    ]
    errors = MachineErrors.of_errors(chain, pairs)
    plain = along_axes(errors, datum, 256, False)
    touches = errors.touches(q, datum.length)
    bare = aligned(touches.point, deviation(errors, touches))
    with_plain = aligned(touches.point, deviation_after(errors, touches, plain.correction(touches)))
    assert rms(with_plain) > 1.1 * rms(bare)
    write_tables(FORMATS["linuxcnc"], tmp_path / "comp", errors, datum, head, q)
    found = verify_tables(FORMATS["linuxcnc"], tmp_path / "comp", errors, datum, head, q)
    assert rms(found.result.after) < rms(found.result.before) - 2 * UM  # Y is still corrected
    assert set(found.left_out) == {"X"}
    # a table left out is no fault of interpolation, and its axis's errors are not represented
    assert found.interpolation < UM
    lines = list(table_lines(found))
    assert any("a table is left out for X" in line for line in lines)
    assert any("cannot represent" in line and "EBX" in line for line in lines)
    refuse_harmful(found)
    harmful = replace(found, result=replace(found.result, after=with_plain))
    with pytest.raises(Harmful, match=r"linuxcnc: the tables would leave .* µm rms .*--within"):
        refuse_harmful(harmful)


SWIVEL = """format = "machine/1"
name = "swivel"
chain = "[w C' B' f X Y Z t]"
[axis]
X.range = [-250.0, 250.0]
Y.range = [-225.0, 225.0]
Z.range = [-400.0, 0.0]
C.range = [-360.0, 360.0]
[axis.B]
range = [-5.0, 180.0]
direction = [0.0, -0.70710678, 0.70710678]
point = [0.0, 5.0, -470.0]
[workpiece]
origin = [0.0, 0.0, -540.0]
"""


@pytest.mark.parametrize("name", ["heidenhain", "iso230", "sinumerik", "linuxcnc"])
def test_a_table_of_an_inclined_swivel_corrects_its_positioning(name, tmp_path):
    """EBB of 100 urad at its ends, none at the datum: minus EBB on the reading leaves nothing."""
    (tmp_path / "swivel.toml").write_text(SWIVEL)
    chain = read_machine(tmp_path / "swivel.toml")
    datum = datum_of(chain, {"Z": -200.0, "B": 87.5 * DEG}, 160.0)
    q = sample_workspace(chain, {}, 300)
    errors = only(chain, "geometric(EBB,linear)", 100 * URAD)
    head = header_of(chain, "0123456789ab", datum, State())
    write_tables(FORMATS[name], tmp_path / name, errors, datum, head, q)
    result = verify_tables(FORMATS[name], tmp_path / name, errors, datum, head, q).result
    assert rms(result.before) > 5 * UM
    assert rms(result.after) < 0.01 * UM
    if name == "heidenhain":
        column, b = columns(tmp_path / name / "B.COM", "NR AXISPOS B"), chain.axis_index("B")
        read = q.copy()
        at = np.clip(q[:, b] / DEG, *column[[0, -1], 1])
        read[:, b] -= np.interp(at, column[:, 1], column[:, 2]) * DEG
        touches = errors.touches(read, datum.length)
        left = exact_tip(chain, read, datum.length, errors.contribution(touches))
        assert rms(left - tip(chain, q, datum.length)) < 0.1 * UM  # steps of 1e-6 degrees


# --- signs, heads, refusals -----------------------------------------------------------------


@pytest.mark.parametrize("name", list(FORMATS))
def test_the_sign_switch_turns_every_value(
    known, datum, bench_chain, written, poses, tmp_path, name
):
    head = header_of(bench_chain, "0123456789ab", datum, State(), sign=-1)
    write_tables(FORMATS[name], tmp_path, known, datum, head, poses)
    mine, _ = FORMATS[name].read(written / name, bench_chain)
    theirs, found = FORMATS[name].read(tmp_path, bench_chain)
    assert found == head
    touches = known.touches(poses[:8], LENGTH)
    np.testing.assert_allclose(theirs.correction(touches), mine.correction(touches), atol=1 * NM)
    table = {"iso230": "iso230.csv", "heidenhain": "X.COM", "sinumerik": "NC_CEC.INI"}
    file = table.get(name, "X.comp")
    assert (tmp_path / file).read_text() != (written / name / file).read_text()


@pytest.mark.parametrize("name", list(FORMATS))
def test_the_one_point_test_detects_a_wrong_sign(results, datum, bench_chain, name):
    test = results[name].acceptance
    moved = np.flatnonzero(test.q != datum.q)
    assert [bench_chain.axes[k] for k in moved] == [test.axis]
    change = test.with_table - test.without
    np.testing.assert_allclose(test.wrong_sign - test.without, -change, atol=0.1 * UM)
    assert np.abs(change).max() > 20 * UM
    if name in ("iso230", "sinumerik"):
        assert np.linalg.norm(test.with_table) < 0.2 * np.linalg.norm(test.without)


def test_heads_are_read_back(written, head):
    for path in sorted(p for p in written.rglob("*") if p.is_file()):
        assert Header.of(path.read_text(), path) == head, path
    with pytest.raises(BadFile, match="matstd model"):
        Header.of("X EXX\n", "lost.csv")


def test_a_table_of_another_machine_or_datum_is_refused(known, head, written, bench_chain, poses):
    other_datum = datum_of(bench_chain, {"X": 9.0}, LENGTH)
    other = header_of(bench_chain, head.model, other_datum, State())
    with pytest.raises(BadFile, match=r"matstd datum: found C0 B0 X0 Y0 Z-200 L160.*X9"):
        verify_tables(FORMATS["iso230"], written / "iso230", known, other_datum, other, poses)
    short = make_chain("bench", "[w f X t]", {"X": Axis(range=(0.0, 1.0))})
    elsewhere = header_of(short, head.model, datum_of(short, {}, LENGTH), State())
    with pytest.raises(BadFile, match="matstd machine: found bench, "):
        head.check(elsewhere, "iso230.csv")


def test_commands(bench, errors_file, tmp_path, answer, refusal):
    out = tmp_path / "out"
    command = ["compensate", str(bench), "--errors", str(errors_file), "--tables", str(out)]
    command += ["--tool-length", "160", "--control", "iso230"]
    assert "represents every error" in answer(command)
    assert {p.name for p in out.iterdir()} >= {"iso230", "report.html", "compensation.json"}
    assert "already exists" in refusal(command)
    active = ["--force", "--active", str(out / "iso230" / "iso230.csv")]
    assert "would correct twice" in refusal([*command, *active])
    assert "matstd datum" in refusal([*command, *active, "--switch", "EXX=0", "--datum", "X=5"])
    errors_file2 = tmp_path / "other.toml"
    errors_file2.write_text('format = "errors/1"\nEXX = { shape = "linear", amplitude = 1.0 }\n')
    other = [w if w != str(errors_file) else str(errors_file2) for w in command]
    assert "or a model learnt beside it" in refusal([*other, *active])


@pytest.mark.parametrize(
    ("words", "said"),
    [
        (["--datum", "X=900"], "--datum X=900: expected -400 to 400, the travel of X"),
        (["--datum", "Q=1"], "unknown axis 'Q'"),
        (["--datum", "X"], "expected a name and a number"),
        (["--within", "X=5"], "such as X=-100:100"),
        (["--within", "X=9:3"], "the smaller end first"),
        (["--control", "fanuc"], "control fanuc: expected one of iso230"),
        (["--switch", "EQQ=0"], "expected one of"),
        (["--switch", "all=0"], "no error of an axis is known and switched on"),
        (["--temperature", "bed=warm"], "--temperature bed=warm"),
    ],
)
def test_bad_words_are_refused(bench, errors_file, tmp_path, refusal, words, said):
    command = ["compensate", str(bench), "--errors", str(errors_file), "--tool-length", "160"]
    assert said in refusal([*command, "--tables", str(tmp_path / "no"), *words])
    assert not (tmp_path / "no").exists()


MODEL = """format = "model/1"
covariance = [[0.01]]
[machine]
name = "small"
chain = "[w X' f Y Z t]"
[machine.axis.X]
range = [-200.0, 200.0]
[machine.axis.Y]
range = [-150.0, 150.0]
[machine.axis.Z]
range = [-400.0, 0.0]
[source]
run = "run.csv"
touches = 240
noise_um = 0.6
[[effect]]
name = "thermal-static(EZZ,frame)"
[effect.estimate]
amplitude_um_per_K = 4.0
"""


def test_what_a_model_follows_has_to_be_stated(tmp_path, refusal):
    """4 µm/K of growth along Z, 5 K above 20 degC: the zero of Z moves by 20 µm."""
    path, out = tmp_path / "model.toml", tmp_path / "out"
    path.write_text(MODEL)
    command = ["compensate", str(path), "--tool-length", "160", "--control", "linuxcnc"]
    command += ["--tables", str(out)]
    assert "expected --temperature, --rpm or --value" in refusal(command)
    assert main([*command, "--temperature", "frame=25"]) == 0
    z = columns(out / "linuxcnc" / "Z.comp", "# matstd sign")
    np.testing.assert_allclose(z[:, 1:], -0.020, atol=1e-6)
    assert "T_frame=25" in (out / "linuxcnc" / "Z.comp").read_text()


def test_a_remaining_location_error_has_the_size_that_its_run_determines(bench_chain):
    """A parameter of 21 ± 30 µm whose line the run determines to 29.2 ± 0.6: both scale alike."""
    errors = only(bench_chain, "location(EX0C)", 21 * UM)
    left = UncorrectedError(name="EX0C", before=20 * UM, rms=10 * UM, u=15 * UM)
    rows = errors.parameter_rows("EX0C")
    assert _as_determined(left, errors, rows) is left
    known = replace(errors, determined={"EX0C": Estimate(-29.4 * UM, 0.6 * UM)})
    # errors that are not switched keep what their run determines; others are no longer those of it
    assert known.switched({}).determined == known.determined
    assert known.switched({"EX0C": 0.5}).determined == {}
    found = _as_determined(left, known, rows)
    # 20 of 21 µm at the tool after alignment, of which half remains
    np.testing.assert_allclose(found.before, 28.0 * UM)
    np.testing.assert_allclose(found.rms, 14.0 * UM)
    np.testing.assert_allclose(found.u, 0.6 / 2.1 * UM)


def test_an_error_that_grows_is_explained():
    """Of three errors one grows: 130 of 57 µm; that by a rounding does not count."""
    sizes = {"EYZ": (57.0, 130.0), "EX0C": (20.0, 20.0), "EXX": (30.0, 30.1)}
    left = [UncorrectedError(name, a * UM, b * UM, 0.0) for name, (a, b) in sizes.items()]
    said = grown_sentence(left)
    assert said.startswith("more of EYZ remains than there was")
    assert grown_sentence(left[1:]) == ""
