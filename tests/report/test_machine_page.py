"""The page of a machine: its bodies, its errors as functions, and the kinematics of its scripts."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from browser import faults, opened, page_data, requests
from unchanged import summary

import matstd
from matstd.compensation.field import MachineErrors, State
from matstd.report.machine import (
    Played,
    ShownMachine,
    body_meshes,
    error_functions,
    machine_html,
    thinned,
)
from matstd.report.machine.chain_bodies import chain_bodies
from matstd.report.machine.error_series import series_at
from matstd.report.machine.machine_page import _data
from matstd.sensitivity.population import Population, drawn_errors
from matstd.twin.errors import BadFile
from matstd.twin.files import read_machine
from matstd.twin.library import parse_sized_effect
from matstd.twin.machine import Axis, exact_tip, make_chain
from matstd.twin.machine.kinematics import carriers
from matstd.twin.units import UM

ROOT = Path(__file__).parents[2]
MACHINES = sorted((ROOT / "examples" / "machines").glob("*-machine.toml"))
HSM = ROOT / "matstd" / "machines" / "hsm600u.toml"
LENGTH, SHIFT = 150.0, 8 * 3600.0
KINDS = (
    "backlash(X)=6um",
    "thermal-lag(EZZ)=25um,tau=18min",
    "coupling(EBX,Z)=40urad",
    "geometric(EYX,6)=T1=3um,T4=2um",
)


@pytest.fixture(scope="module")
def machine():
    """A machine with every error of ISO 230-1 and four effects of other kinds."""
    chain = read_machine(HSM)
    drawn = drawn_errors(Population(chain), np.random.default_rng(3))
    more = [parse_sized_effect(text, chain) for text in KINDS]
    known = [*drawn, *((one.effect, one.theta) for one in more)]
    return MachineErrors.of_errors(chain, known, State(spindle_rpm=9000.0))


@pytest.fixture(scope="module")
def poses(machine):
    """Readings, sides and times at random."""
    rng = np.random.default_rng(4)
    low, high = np.array([machine.chain.link(a).range for a in machine.chain.axes]).T
    q = rng.uniform(low, high, (40, len(low)))
    return q, rng.choice([-1, 0, 1], q.shape), rng.uniform(0.0, SHIFT, 40)


def summed(functions, chain, q, sides, time):
    """Twist and place of all errors from their series."""
    limits = np.array([*(chain.link(a).range for a in chain.axes), (0.0, SHIFT)])
    x = np.column_stack([q, time])
    u = (2.0 * x - limits.sum(axis=1)) / np.ptp(limits, axis=1)
    out = {part: np.zeros((len(q), len(chain.links), 6)) for part in ("twist", "place")}
    for one in functions:
        for s in one.series:
            value = series_at(s.coefficients, u[:, list(s.readings)])
            if s.side is not None:
                value = np.where(sides[:, s.side[0]] == s.side[1], value, 0.0)
            out[s.part][:, s.link, s.component] += value
    return out


def test_errors_are_functions_to_the_last_digits(machine, poses):
    q, sides, time = poses
    functions = error_functions(machine, LENGTH, SHIFT)
    assert len(functions) == len(machine.groups)
    assert not any(one.left_out for one in functions)
    exact = machine.contribution(machine.touches(q, LENGTH, sides.astype(float), time))
    found = summed(functions, machine.chain, q, sides, time)
    for part in ("twist", "place"):
        assert np.abs(found[part] - getattr(exact, part)).max() < 1e-15
    # the largest first, each with its words
    sizes = [one.size for one in functions]
    assert sizes == sorted(sizes, reverse=True)
    lost = next(one for one in functions if one.name == "backlash(X)")
    assert lost.size == pytest.approx(3.0 * UM)
    assert "X" in lost.words
    assert lost.title == "reversal of X"
    assert {"X", "linear_translation"} <= set(
        next(one for one in functions if one.name == "EXX").words
    )


def test_what_is_too_fast_for_a_series_is_said(machine):
    """Of 2 000 waves over the travel a series of degree 1024 has no idea."""
    chain = machine.chain
    effect = parse_sized_effect("periodic(EXX)=sin=5um,period=0.4mm", chain)
    known = MachineErrors.of_errors(chain, [(effect.effect, effect.theta)])
    functions = error_functions(known, LENGTH, SHIFT)
    off = max(s.off for one in functions for s in one.series)
    assert off > 0.01 * UM
    page = machine_html(ShownMachine(chain=chain, length=LENGTH, duration=SHIFT, errors=functions))
    assert "drawn smoothed, by up to" in page


@pytest.mark.parametrize("path", [*MACHINES, HSM], ids=lambda p: p.stem)
def test_every_axis_has_a_body_and_its_letter(path):
    chain = read_machine(path)
    bodies, letters = chain_bodies(chain, LENGTH)
    assert {k.text for k in letters} == set(chain.programmed_axes)
    assert {body.on for body in bodies} >= {*chain.programmed_axes, "t", "f"}
    for body in bodies:
        assert body.corners.shape[1:] == (3, 3)
        assert np.all(np.isfinite(body.corners))
    tool = np.concatenate([b.corners.reshape(-1, 3) for b in bodies if b.on == "t"])
    assert tool[:, 2].min() == pytest.approx(-LENGTH - 6.0, abs=1e-9)
    # rails, or the ram, are at least as long as the travel
    for k, link in enumerate(chain.links):
        if link.kind != "linear":
            continue
        step = 1 if link.carries_workpiece else -1
        carrier = chain.links[k + step].name if 0 < k < len(chain.links) - 1 else "f"
        is_last = link.carries_workpiece != chain.links[k + step].carries_workpiece
        held = {link.name, "f" if is_last else carrier}
        points = np.concatenate([b.corners.reshape(-1, 3) for b in bodies if b.on in held])
        assert np.ptp(points @ link.direction) >= np.ptp(link.range)


def test_bodies_of_all_machines(unchanged):
    lines = []
    for path in (*MACHINES, HSM):
        bodies, letters = chain_bodies(read_machine(path), LENGTH)
        lines.append(path.stem)
        lines += [f"{b.on} {b.colour} {summary(b.corners)}" for b in bodies]
        lines += [f"{k.text} on {k.on} {summary(k.place)}" for k in letters]
    unchanged("\n".join(lines) + "\n")


def test_bearings_stand_on_a_foot_that_nothing_which_swings_reaches():
    """Whatever the angle of a cradle, 15 mm are left between it and the foot."""
    chain = read_machine(HSM)
    bodies, _ = chain_bodies(chain, LENGTH)
    link = chain.link("B")
    off = {on: [b.corners.reshape(-1, 3) - link.point for b in bodies if b.on == on] for on in "BX"}
    swing = np.linalg.norm(np.cross(np.concatenate(off["B"]), link.direction), axis=1).max()
    levels = np.concatenate(off["X"])[:, 2]
    assert np.isclose(levels, -(swing + 15.0)).any()
    assert not ((levels < -swing) & (levels > -swing - 14.0)).any()


def test_bodies_of_an_arm_are_drums_and_tubes(tmp_path):
    text = 'format = "machine/1"\nname = "arm"\nchain = "[w f C A A2 C2 A3 t]"\n[axis.C]\n'
    text += "range = [-180, 180]\n"
    for name, z in (("A", 900), ("A2", 600), ("C2", 300), ("A3", 200)):
        text += f"[axis.{name}]\nrange = [-90, 90]\npoint = [0, 0, {z}]\n"
    path = tmp_path / "arm.toml"
    path.write_text(text)
    bodies, letters = chain_bodies(read_machine(path), LENGTH)
    assert [k.text for k in letters] == ["A3", "C2", "A2", "A", "C"]
    assert {"A", "A2", "f"} <= {body.on for body in bodies}
    # the wrist is drawn at the point of its line next to the tool, each joint next to the one after
    drums = {k.text: k.place for k in letters}
    assert [drums[name][2] for name in ("A3", "A2", "A")] == pytest.approx([200.0, 600.0, 900.0])
    # of a line along the arm it is the place to which the arm has come, with its letter above
    assert 200.0 < drums["C2"][2] < 300.0
    assert 900.0 < drums["C"][2] < 1100.0


def write_block(path, size=40.0, detail=0):
    import trimesh

    mesh = trimesh.creation.box((size, size, size))
    if detail:
        mesh = trimesh.creation.icosphere(detail, size)
    mesh.export(path)
    return mesh


def with_bodies(tmp_path, table):
    path = tmp_path / "machine.toml"
    head, rest = HSM.read_text(encoding="utf-8").split("[axis.X]", 1)
    path.write_text(f"{head}\n[bodies]\n{table}\n\n[axis.X]{rest}", encoding="utf-8")
    return path


def test_drawings_of_the_user_take_the_place_of_plain_bodies(tmp_path):
    write_block(tmp_path / "ram.stl")
    path = with_bodies(tmp_path, 'Z = "ram.stl"')
    page = matstd.show(path)
    assert [body.on for body in page.shown.bodies] == ["Z"]
    assert page.shown.bodies[0].corners.shape == (12, 3, 3)
    assert page.shown.replaced == ["Z"]
    assert "Bodies of Z are from your files." in page.html
    # a machine with drawings is the same machine
    assert read_machine(path).difference(read_machine(HSM)) is None


@pytest.mark.parametrize(
    ("file", "content", "found"),
    [
        ("a.txt", b"solid", r"a\.txt: name: found '?\.txt"),
        ("a.stl", None, "nothing"),
        ("a.stl", b"nonsense" * 40, "no mesh|0 triangles"),
        ("a.stl", b"solid x\nendsolid x\n", "0 triangles|no mesh"),
        ("far.stl", 3e5, "is the file in mm"),
    ],
)
def test_drawings_that_are_none_are_refused(tmp_path, file, content, found):
    if isinstance(content, float):
        write_block(tmp_path / file, content)
    elif content is not None:
        (tmp_path / file).write_bytes(content)
    path = with_bodies(tmp_path, f'X = "{file}"')
    with pytest.raises(BadFile, match=found):
        matstd.show(path)


def test_a_drawing_of_no_link_is_refused(tmp_path):
    path = with_bodies(tmp_path, 'A = "a.stl"')
    with pytest.raises(BadFile, match=r"bodies.*A.*f, w, C, B, X, Y, Z, C1, t"):
        matstd.show(path)


def test_many_triangles_are_thinned(tmp_path):
    path = tmp_path / "big.stl"
    mesh = write_block(path, 200.0, 6)
    assert len(mesh.faces) > 80_000
    (body,) = body_meshes(replace(read_machine(HSM), drawings={"X": path}))
    assert 2_000 < len(body.corners) <= 20_000
    away = np.linalg.norm(body.corners.reshape(-1, 3), axis=1)
    assert np.abs(away - 200.0).max() < 5.0
    few = np.zeros((12, 3, 3))
    assert thinned(few) is few


@pytest.mark.slow
def test_a_step_file_is_a_body(tmp_path):
    from build123d import Box, export_step

    export_step(Box(20, 30, 40), tmp_path / "x.step")
    chain = read_machine(HSM)
    (body,) = body_meshes(replace(chain, drawings={"X": tmp_path / "x.step"}))
    assert np.ptp(body.corners.reshape(-1, 3), axis=0) == pytest.approx([20, 30, 40], abs=1e-6)
    (tmp_path / "y.stp").write_text("ISO-10303-21; nonsense")
    with pytest.raises(BadFile, match="no body"):
        body_meshes(replace(chain, drawings={"X": tmp_path / "y.stp"}))


# ---- in a browser


@pytest.fixture(scope="module")
def page(machine, tmp_path_factory):
    functions = error_functions(machine, LENGTH, SHIFT)
    shown = ShownMachine(
        chain=machine.chain, length=LENGTH, duration=SHIFT, errors=functions, source="x.toml"
    )
    path = tmp_path_factory.mktemp("machine") / "machine.html"
    path.write_text(machine_html(shown), encoding="utf-8")
    return path


def run(browser, script, *arguments):
    return browser.execute_script(script, *arguments)


@pytest.mark.browser
def test_the_page_multiplies_as_the_twin(browser, page, machine, poses):
    """Nominal and actual tool points with all errors, against matstd.twin to 1e-12 of a metre."""
    opened(browser, page)
    q, sides, time = poses
    found = np.array(
        run(
            browser,
            """const [q, sides, time] = arguments, p = machinePage;
            return q.map((row, i) => {
              const pose = { q: row, sides: sides[i], time: time[i] };
              return [...p.toolPoint(row, 150), ...p.toolPoint(row, 150, p.errorsAt(pose))];
            });""",
            q.tolist(),
            sides.tolist(),
            time.tolist(),
        )
    )
    touches = machine.touches(q, LENGTH, sides.astype(float), time)
    nominal = exact_tip(machine.chain, q, LENGTH, _none(machine.chain, len(q)))
    actual = exact_tip(machine.chain, q, LENGTH, machine.contribution(touches))
    assert np.abs(found[:, :3] - nominal).max() < 1e-12 * 1000.0
    assert np.abs(found[:, 3:] - actual).max() < 1e-12 * 1000.0
    assert faults(browser) == []
    assert requests(browser) == []


def _none(chain, n):
    from matstd.twin.machine import Contribution

    return Contribution.zeros(n, len(chain.links))


@pytest.mark.browser
@pytest.mark.parametrize(
    ("path", "leans"),
    [*((path, False) for path in MACHINES), (HSM, True)],
    ids=lambda value: getattr(value, "stem", "leaning" if value else "upright"),
)
def test_bodies_stand_where_the_twin_has_them(browser, path, leans, tmp_path):
    """Bodies by the chain of carriers; the tool seen from the table with random errors."""
    text = path.read_text(encoding="utf-8")
    if leans:  # a swivel of 45 degrees, and an axis against its letter
        text = text.replace("[axis.B]", "[axis.B]\ndirection = [0.0, -1.0, 1.0]")
        text = text.replace("[axis.Y]", "[axis.Y]\ndirection = [0.0, -1.0, 0.0]")
    (tmp_path / "machine.toml").write_text(text, encoding="utf-8")
    chain = read_machine(tmp_path / "machine.toml")
    assert any(not link.is_along_letter for link in chain.links) is leans
    rng = np.random.default_rng(5)
    low, high = np.array([chain.link(a).range for a in chain.axes]).T
    q = rng.uniform(low, high, (5, len(low)))
    contribution = _none(chain, len(q))
    contribution.twist[:] = 1e-3 * rng.normal(size=contribution.twist.shape)
    contribution.place[:] = 1e-3 * rng.normal(size=contribution.place.shape)
    page = tmp_path / "machine.html"
    page.write_text(machine_html(ShownMachine(chain=chain, length=LENGTH, duration=1.0)))
    opened(browser, page)
    out = run(
        browser,
        """const [q, twist, place] = arguments, p = machinePage;
        return q.map((row, i) => {
          const errors = { twist: Float64Array.from(twist[i]), place: Float64Array.from(place[i]) };
          const plain = p.bodyPoses(row), moved = p.bodyPoses(row, errors);
          const lists = poses => Object.fromEntries(
            Object.entries(poses).map(([name, m]) => [name, [...m]]));
          return [lists(plain), lists(moved), p.toolPoint(row, 150, errors)];
        });""",
        q.tolist(),
        contribution.twist.reshape(len(q), -1).tolist(),
        contribution.place.reshape(len(q), -1).tolist(),
    )
    T_machine_carrier, T_machine_table, T_machine_tool = carriers(chain, q)
    names = [link.name for link in chain.links]
    actual = exact_tip(chain, q, LENGTH, contribution)
    for n, (plain, moved, tip) in enumerate(out):
        for i in range(len(names)):
            inward = names[i + 1 :] if chain.links[i].carries_workpiece else names[:i][::-1]
            same = [k for k in inward if chain.link(k).carries_workpiece
                    == chain.links[i].carries_workpiece]  # fmt: skip
            carrier = np.reshape(plain[same[0] if same else "f"], (4, 4)).T
            assert np.abs(carrier - T_machine_carrier[n, i]).max() < 1e-9
        assert np.abs(np.reshape(plain["t"], (4, 4)).T - T_machine_tool[n]).max() < 1e-9
        table = np.reshape(plain["w"], (4, 4)).T @ np.array([*chain.table_origin, 1.0])
        assert np.abs(table - T_machine_table[n, :, 3]).max() < 1e-9
        at_tool = np.reshape(moved["t"], (4, 4)).T @ [0.0, 0.0, -LENGTH, 1.0]
        seen = np.linalg.solve(np.reshape(moved["w"], (4, 4)).T, at_tool)[:3] - chain.table_origin
        assert np.abs(seen - actual[n]).max() < 1e-9
        assert np.abs(np.array(tip) - actual[n]).max() < 1e-9
    assert faults(browser) == []


@pytest.mark.browser
def test_errors_are_switched_and_scaled(browser, page, machine, poses):
    opened(browser, page)
    size = "return Number(document.getElementById('size').textContent)"
    q = poses[0][0]
    run(browser, "machinePage.state.q.set(arguments[0]); machinePage.show()", q.tolist())
    before = run(browser, size)
    touches = machine.touches(q[None], LENGTH)
    actual = exact_tip(machine.chain, q[None], LENGTH, machine.contribution(touches))
    nominal = exact_tip(machine.chain, q[None], LENGTH, _none(machine.chain, 1))
    assert before == pytest.approx(np.linalg.norm(actual - nominal) / UM, abs=0.006)
    # one class doubled: as the words of `switched`
    run(
        browser,
        """const list = document.querySelector("#errors select");
        list.value = "squareness"; list.dispatchEvent(new Event("change"));
        const range = document.querySelectorAll("#errors > label.slider input")[0];
        range.value = 2; range.dispatchEvent(new Event("input"));""",
    )
    double = machine.switched({"squareness": 2.0})
    actual = exact_tip(machine.chain, q[None], LENGTH, double.contribution(touches))
    assert run(browser, size) == pytest.approx(np.linalg.norm(actual - nominal) / UM, abs=0.006)
    shown = run(
        browser, "return [...document.querySelectorAll('#errors li')].filter(e => !e.hidden).length"
    )
    assert shown == sum("squareness" in machine.words(g) for g in machine.groups)
    # everything off
    run(
        browser,
        """const list = document.querySelector("#errors select");
        list.value = ""; list.dispatchEvent(new Event("change"));
        [...document.querySelectorAll("#errors button")].find(b => b.textContent === "off").click();
        """,
    )
    assert run(browser, size) == 0.0
    assert not run(browser, "return document.getElementById('none').hidden")
    # one on again, by its switch and from the keyboard
    run(browser, "document.querySelectorAll('#errors li input[type=checkbox]')[0].click()")
    name = error_functions(machine, LENGTH, SHIFT)[0].name
    actual = exact_tip(machine.chain, q[None], LENGTH, machine.only(name).contribution(touches))
    assert run(browser, size) == pytest.approx(np.linalg.norm(actual - nominal) / UM, abs=0.006)
    assert faults(browser) == []


@pytest.mark.browser
def test_axes_move_and_sensitivities_follow(browser, page, machine):
    opened(browser, page)
    run(
        browser,
        """const range = document.getElementById("axis-B");
        range.value = -45; range.dispatchEvent(new Event("input"));
        document.getElementById("sensitivities").open = true;""",
    )
    assert run(browser, "return machinePage.state.q[1]") == pytest.approx(-np.pi / 4.0)
    q = np.array([run(browser, "return [...machinePage.state.q]")])
    run(browser, "document.getElementById('sensitivities').dispatchEvent(new Event('toggle'))")
    shown = run(
        browser,
        """return [...document.querySelectorAll("#sensitivities li")].map(e => [
          e.children[0].textContent, parseFloat(e.querySelector("output").textContent)]);""",
    )
    found = matstd.sensitivities(machine.chain, (q, np.array([LENGTH]))).columns()
    assert [name for name, _ in shown] == list(found)
    for name, value in shown:
        assert value == pytest.approx(float(found[name][0]), rel=6e-3, abs=1e-6), name


@pytest.mark.browser
def test_a_part_program_is_played(browser, tmp_path):
    program = tmp_path / "part.ngc"
    program.write_text("G21 G90\nG0 X0 Y0 Z20\nG1 X100 F600\nG1 Y50\nG1 X0\nG0 Z50\nM2\n")
    path = tmp_path / "machine.html"
    shown = matstd.show(HSM, program=program, add=["backlash(X)=6um"], datum={"Z": -300.0})
    shown.save(path)
    opened(browser, path)
    length, names = run(
        browser, "return [machinePage.panel.player.last, machinePage.data.program.names]"
    )
    assert names == ["part.ngc"]
    # 250 mm at 600 mm/min and two rapid ways
    assert length == pytest.approx(25.0, abs=3.0)
    lines = []
    for _ in range(4):
        run(browser, "document.querySelector('#program button[aria-label=\"next line\"]').click()")
        lines.append(run(browser, "return document.querySelector('.program .now').textContent"))
    assert lines == ["G1 X100 F600", "G1 Y50", "G1 X0", "G0 Z50"]
    run(browser, "machinePage.panel.go(machinePage.panel.player.last - 1e-3)")
    assert run(browser, "return machinePage.state.sides[2]") == -1  # X came from above
    assert float(run(browser, "return document.getElementById('deviation-x').textContent"
                     ).replace("−", "-")) == pytest.approx(-3.0)  # fmt: skip
    run(
        browser,
        """machinePage.panel.go(0);
        document.querySelector('#program button[aria-label="play the program"]').click();""",
    )
    assert run(browser, "return machinePage.panel.isPlaying")
    assert faults(browser) == []
    assert requests(browser) == []


@pytest.mark.browser
@pytest.mark.parametrize("width", [800, 1280, 2560])
def test_nothing_overflows_in_light_and_dark(browser, page, width):
    browser.set_window_size(width, 900)
    opened(browser, page)
    run(browser, "document.getElementById('theme').click()")
    wide = run(browser, "return [document.documentElement.scrollWidth, innerWidth]")
    assert wide[0] <= wide[1]
    unlabelled = run(
        browser,
        """return [...document.querySelectorAll("input, select, button")].filter(e =>
          !(e.getAttribute("aria-label") || e.textContent || e.closest("label"))).length""",
    )
    assert unlabelled == 0
    assert faults(browser) == []


def test_the_data_are_those_of_the_machine(page, machine):
    text = page.read_text(encoding="utf-8")
    assert "http" not in text.replace("http://www.w3.org", "")
    found = page_data(text)
    assert [k["name"] for k in found["machine"]["links"]] == [k.name for k in machine.chain.links]
    assert len(found["symbols"]) == 71


def boxed(html):
    """Words of the box at the head."""
    box = html.partition('<dl class="box">')[2].partition("</dl>")[0]
    return box.replace("\xa0", " ").replace("<code>", "`").replace("</code>", "`")


def test_the_box_states_what_the_errors_do_and_what_to_do(machine):
    functions = error_functions(machine, LENGTH, SHIFT)
    shown = ShownMachine(chain=machine.chain, length=LENGTH, duration=SHIFT, errors=functions)
    largest = max(functions, key=lambda one: one.size)
    said = boxed(machine_html(shown))
    assert f"tool 150 mm): {title_of(largest)}" in said
    assert f"{len(functions) - 3} other errors displace it less." in said
    assert "`--program` plays" in said
    assumed = boxed(machine_html(replace(shown, is_assumed=True)))
    assert "not those of yours" in assumed
    assert "`matstd show MACHINE.toml --model model.toml`" in assumed


def title_of(one):
    return f"displacement of the line of {one.name[-1]} along {one.name[1]} [{one.name}]"


@pytest.mark.parametrize(
    ("gap", "words"),
    [
        ([4.0, 2.5, 9.0], ("keeps 2.50 mm clear of every body; VICE is nearest, at line 7 of P1",
                           "follow the set-up sheet")),
        ([4.0, -0.5, 9.0], ("runs into VICE at block 6 of P1", "Do not run these programs")),
        (None, ("Without", "`--standard STANDARD.toml`")),
    ],
)  # fmt: skip
def test_the_box_of_a_playback_names_the_nearest_body(machine, gap, words):
    count, whole = len(machine.chain.axes), np.arange(3)
    played = Played(
        names=("P1",),
        # of a control that numbers its blocks, and of one that does not
        texts=("".join(f"{k} L X\n" if gap and gap[1] < 0 else "G0 X1\n" for k in range(9)),),
        time=whole.astype(float),
        q=np.zeros((3, count)),
        sides=np.zeros((3, count), dtype=int),
        length=np.full(3, LENGTH),
        line=np.array([3, 7, 9]),
        which=np.zeros(3, dtype=int),
        touch=whole,
        features=({1: "SPH1", 2: "SPH2"},),
        clearance=None if gap is None else np.array(gap),
        nearest=None if gap is None else np.array(["BASE", "VICE", "BASE"]),
    )
    shown = ShownMachine(chain=machine.chain, length=LENGTH, duration=SHIFT, program=played)
    said = boxed(machine_html(shown))
    first, then = words
    assert then in said
    assert (first in said) is (gap is not None)


@pytest.mark.parametrize(
    ("notation", "up"),
    [
        ("[w C' B' X' f Y Z t]", "z"),
        ("[w B' X' f Y Z t]", "y"),
        ("[w B' A' X' f Z Y t]", "y"),  # the table stands on a cradle
        ("[w B' C' X' f Y Z t]", "z"),
        ("[w X' f Y Z B C t]", "z"),
    ],
)
def test_a_machine_with_a_table_about_y_is_drawn_level(notation, up):
    axes = {name.strip("'"): Axis((-1.0, 1.0)) for name in notation.split()[1:-1] if name != "f"}
    chain = make_chain("a", notation, axes)
    shown = ShownMachine(chain=chain, length=100.0, duration=SHIFT)
    assert _data(shown, (), ())["up"] == up
