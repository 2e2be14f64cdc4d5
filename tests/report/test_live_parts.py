"""Parts of live pages, in a real browser: data, view in three dimensions, plots, numbers."""

import re
from pathlib import Path

import numpy as np
import pytest
from browser import faults, opened, requests, run

from matstd.report import live
from matstd.report.live import packed, scripted, style

PAGES = {f.stem for f in (Path(live.__file__).parent / "pages").glob("*.js")}

# two triangles of a square of 20 mm at z = 0, and a square of the same size 10 mm below
SQUARE = np.array(
    [[[-10, -10, 0], [10, -10, 0], [10, 10, 0]], [[-10, -10, 0], [10, 10, 0], [-10, 10, 0]]]
)
NUMBERS = np.array([np.pi, -1e-9, 0.0, 6.02e23, 1.0 - 1e-13])
KINDS = {"f8": 0.0, "f6": 2e-11, "f4": 6e-8, "f3": 2e-4}  # with the share that they lose
POINTS = np.array([[0.0, 0.0, 0.0], [6.0, 0.0, 0.0], [0.0, 0.0, -8.0]])

SCENE = """
const { View3D } = parts.view3d;
const { pageData } = parts.data;
const data = await pageData();
document.body.innerHTML = '<canvas id="c" style="width:400px;height:400px"></canvas>';
const view = new View3D(document.getElementById("c"), { isDrawn: ISDRAWN });
window.body = view.mesh({ corners: data.square.values, colour: [1, 0.8, 0], isPickable: true });
window.dots = view.points({ positions: data.points.values, size: 12,
  colours: new Uint8Array([255, 0, 0, 0, 128, 0, 0, 0, 255]) });
window.needle = view.lines({ positions: new Float32Array([-6, -6, 0, -6, -6, 9]), size: 4,
  colours: new Uint8Array([0, 0, 0]) });
window.view = view;
view.fit();
view.camera.tilt = 1.2;
view.draw();
"""


@pytest.fixture(scope="module")
def page(tmp_path_factory):
    """A page whose script does nothing but import every part."""
    data = {
        "square": packed(SQUARE, "i2", grain=0.05, unit="mm", name="a square"),
        "points": packed(POINTS, "f4", unit="mm"),
        "words": ["</script>", "µ", None, 3],
        **{kind: packed(NUMBERS, kind) for kind in KINDS},
    }
    parts = [name for name in live._sources() if name not in PAGES]
    every = "".join(f'import * as {name} from "./{name}.js";\n' for name in parts)
    every += f"window.parts = {{ {', '.join(parts)} }};\n"
    path = tmp_path_factory.mktemp("parts") / "page.html"
    with pytest.MonkeyPatch.context() as patch:
        patch.setitem(live._sources(), "every", every)
        body = f"<body>{scripted('every', data)}</body>"
    head = f"<!DOCTYPE html><meta charset='utf-8'><title>t</title>{style()}"
    path.write_text(head + body, encoding="utf-8")
    return path


@pytest.fixture(params=["WebGL", "drawn"])
def scene(request, browser, page):
    """The square, three dots and a needle, seen steeply from above."""
    opened(browser, page)
    run(browser, SCENE.replace("ISDRAWN", str(request.param == "drawn").lower()))
    assert run(browser, "return view.isGl") == (request.param == "WebGL")
    yield browser
    assert faults(browser) == []
    assert requests(browser) == []


def seen(browser, point):
    """Where a point is drawn, pixels of the element, and the colour there."""
    return run(
        browser,
        f"""const [x, y] = view.project({point});
        const copy = document.createElement("canvas");
        [copy.width, copy.height] = [view.canvas.width, view.canvas.height];
        const c = copy.getContext("2d");
        c.drawImage(view.canvas, 0, 0);
        return [x, y, ...c.getImageData(Math.round(x), Math.round(y), 1, 1).data];""",
    )


@pytest.mark.browser
def test_bodies_dots_and_lines_are_drawn_where_they_are(scene):
    assert seen(scene, [0.0, 0.0, 0.0])[2:5] == [255, 0, 0]
    assert seen(scene, [6.0, 0.0, 0.0])[2:5] == [0, 128, 0]
    red, green, blue, _ = seen(scene, [-6.0, 6.0, 0.0])[2:]  # the square, shaded
    assert red > 120
    assert green == pytest.approx(0.8 * red, abs=3)
    assert blue == 0
    assert sum(seen(scene, [-6.0, -6.0, 5.0])[2:5]) < 30  # the needle
    assert seen(scene, [14.0, 2.0, 0.0])[2:5] == [255, 255, 255]
    # from the side of x: a point of larger y stands further right, one of larger z higher
    run(scene, "view.camera.turn = 0; view.camera.tilt = 0.1; view.draw()")
    assert seen(scene, [0.0, 6.0, 0.0])[0] > seen(scene, [0.0, -6.0, 0.0])[0] + 20
    assert seen(scene, [0.0, 0.0, 6.0])[1] < seen(scene, [0.0, 0.0, -6.0])[1] - 20


@pytest.mark.browser
def test_shortened_doubles_keep_their_upper_digits(browser, page):
    opened(browser, page)
    for kind, share in KINDS.items():
        kept = run(browser, f"return [...(await parts.data.pageData()).{kind}.values]")
        assert kept == pytest.approx(NUMBERS.tolist(), rel=share, abs=0.0)
        assert (kept == NUMBERS.tolist()) == (kind == "f8")


@pytest.mark.browser
def test_thousands_of_needles_have_their_own_colours(scene):
    """Thin lines, each of its colour at both ends: a red needle among green ones beside it."""
    run(
        scene,
        """const count = 4000, positions = new Float32Array(6 * count).fill(1e4);
        const colours = new Uint8Array(3 * count);
        for (let i = 0; i < count; i++) colours[3 * i + 1] = 200;
        positions.set([-8, 6, 0, -8, 6, 9], 6 * 2345);
        colours.set([250, 0, 0], 3 * 2345);
        window.many = view.lines({ positions, colours });
        view.draw();""",
    )
    for height in (1.0, 4.5, 8.0):
        x, y, *_ = seen(scene, [-8, 6, height])
        near = run(
            scene,
            f"""const copy = document.createElement("canvas"), c = copy.getContext("2d");
            [copy.width, copy.height] = [view.canvas.width, view.canvas.height];
            c.drawImage(view.canvas, 0, 0);
            return [...c.getImageData({round(x)} - 2, {round(y)}, 5, 1).data];""",
        )
        reddest = max(np.reshape(near, (5, 4)), key=lambda pixel: int(pixel[0]) - int(pixel[1]))
        assert reddest[0] > 100
        assert reddest[1] < 0.6 * reddest[0]


@pytest.mark.browser
@pytest.mark.parametrize(("wide", "high"), [(600, 300), (200, 500)])
def test_a_scene_fills_a_picture_of_any_shape_until_it_is_turned(scene, wide, high):
    run(scene, "view.fit(); view.draw()")
    size = f"view.canvas.style.width = '{wide}px'; view.canvas.style.height = '{high}px';"
    run(scene, size + "view.draw()")
    corners = [*SQUARE.reshape(-1, 3).tolist(), [-6, -6, 9], [0, 0, -8]]
    seen_at = np.array(run(scene, f"return {corners}.map(p => view.project(p))"))
    shares = (seen_at / [wide, high] - 0.5) * 2.0
    assert np.abs(shares).max() == pytest.approx(0.88, abs=0.03)
    run(scene, "view.camera.turn += 0.1")
    turned = run(scene, "return view.camera.far")
    run(scene, "view.canvas.style.width = '400px'; view.draw()")
    assert run(scene, "return view.camera.far") == turned


@pytest.mark.browser
def test_what_lies_behind_a_body_is_not_picked(scene):
    picked = """const [x, y] = view.project(POINT), found = view.pick(x, y);
        return found && [found.layer.kind, found.index];"""
    for k, point in enumerate(POINTS[:2].tolist()):
        assert run(scene, picked.replace("POINT", str(point))) == ["points", k]
    is_gl = run(scene, "return view.isGl")
    # the third stands below the square: WebGL finds the square there
    if is_gl:
        assert run(scene, picked.replace("POINT", str(POINTS[2].tolist()))) == ["mesh", 0]
        assert run(scene, picked.replace("POINT", "[-6, 6, 0]")) == ["mesh", 0]
    assert run(scene, picked.replace("POINT", "[60, 60, 0]")) is None
    run(scene, "body.isVisible = false; view.draw()")
    assert run(scene, picked.replace("POINT", str(POINTS[2].tolist()))) == ["points", 2]


@pytest.mark.browser
def test_changed_colours_and_places_are_drawn(scene):
    run(
        scene,
        """dots.set("colours", new Uint8Array([0, 0, 255, 0, 0, 255, 0, 0, 255]));
        body.place = new Float32Array([1,0,0,0, 0,1,0,0, 0,0,1,0, 0,0,-30,1]); view.draw();""",
    )
    assert seen(scene, [0.0, 0.0, 0.0])[2:5] == [0, 0, 255]
    run(scene, """dots.set("positions", Float32Array.of(0,0,3, 3,3,3, 5,5,9)); view.draw();""")
    assert seen(scene, [5.0, 5.0, 9.0])[2:5] == [0, 0, 255]
    run(scene, "view.remove(dots); view.draw()")
    assert seen(scene, [5.0, 5.0, 9.0])[2:5] != [0, 0, 255]


@pytest.mark.browser
def test_the_camera_obeys_pointer_wheel_and_keys(scene):
    run(
        scene,
        """const kinds = { wheel: WheelEvent, keydown: KeyboardEvent };
        const send = (kind, more) => view.canvas.dispatchEvent(new (kinds[kind] || PointerEvent)(
          kind, { bubbles: true, pointerId: 1, isPrimary: true, ...more }));
        view.canvas.setPointerCapture = () => {};
        window.send = send;""",
    )
    before = run(scene, "return view.camera.turn")
    run(
        scene,
        """send("pointerdown", { clientX: 100, clientY: 100 });
        send("pointermove", { clientX: 150, clientY: 100 }); send("pointerup", {});""",
    )
    assert run(scene, "return view.camera.turn") == pytest.approx(before - 0.4)
    run(scene, "send('pointermove', { clientX: 200, clientY: 100 })")  # nothing is held
    assert run(scene, "return view.camera.turn") == pytest.approx(before - 0.4)
    far = run(scene, "return view.camera.far")
    run(scene, "send('wheel', { deltaY: 100 })")
    assert run(scene, "return view.camera.far") == pytest.approx(far * np.exp(0.1))
    run(scene, "send('keydown', { key: 'ArrowUp' }); send('keydown', { key: '+' })")
    assert run(scene, "return view.camera.far") == pytest.approx(0.85 * far * np.exp(0.1))
    run(scene, "send('keydown', { key: '0' })")
    assert run(scene, "return view.camera.far") == pytest.approx(far)
    # moved with the shift key, the point that was held stays below the pointer
    at = seen(scene, [0.0, 0.0, 0.0])[:2]
    run(
        scene,
        """send("pointerdown", { clientX: 100, clientY: 100 });
        send("pointermove", { clientX: 140, clientY: 80, shiftKey: true }); view.draw();""",
    )
    assert np.subtract(seen(scene, [0.0, 0.0, 0.0])[:2], at) == pytest.approx([40, -20], abs=4)


@pytest.mark.browser
def test_data_come_as_they_were_packed(browser, page):
    opened(browser, page)
    square, points, words = run(
        browser,
        """const { square, points, words } = await parts.data.pageData();
        const plain = p => ({ ...p, values: [...p.values], kind: p.values.constructor.name });
        return [plain(square), plain(points), words];""",
    )
    assert square["values"] == pytest.approx(SQUARE.reshape(-1).tolist())
    assert (square["shape"], square["unit"], square["name"]) == ([2, 3, 3], "mm", "a square")
    assert (points["kind"], points["values"]) == ("Float32Array", POINTS.reshape(-1).tolist())
    assert words == ["</script>", "µ", None, 3]


@pytest.mark.browser
def test_numbers_and_ticks(browser, page):
    opened(browser, page)
    out = run(
        browser,
        """const n = parts.numbers;
        return [n.digits(0.98649), n.digits(-12.345), n.digits(NaN), n.signed(0.5, 2),
          n.digits(123456), n.ticks(0, 1, 5), n.ticks(-0.3, 12, 4), n.ticks(5, 5),
          n.rms([3, 4]), n.quantile([1, NaN, 3, 2], 0.5)];""",
    )
    assert out[:5] == ["0.986", "−12.3", "–", "+0.50", "123456"]
    assert out[5]["at"] == pytest.approx([0.0, 0.2, 0.4, 0.6, 0.8, 1.0])
    assert out[5]["places"] == 1
    assert out[6] == {"at": [0, 5, 10], "places": 0}
    assert out[7]["at"] == [5]
    assert out[8:] == [pytest.approx(12.5**0.5), 2]


@pytest.mark.browser
def test_dots_are_brushed_and_found(browser, page):
    opened(browser, page)
    found = run(
        browser,
        """const { Scatter } = parts.scatter;
        document.body.innerHTML = '<canvas id="p" style="width:300px;height:200px"></canvas>';
        const canvas = document.getElementById("p"), out = {};
        canvas.setPointerCapture = () => {};
        const plot = new Scatter(canvas, { over: i => { out.over = i; },
          brushed: s => { out.brushed = s; } });
        plot.show({ x: [0, 1, 2, NaN], y: [0, 1, 2, 1], colours: new Uint8Array(12),
          xRange: [0, 2], yRange: [0, 2] });
        const at = (v, w) => ({ clientX: plot.frame.px(v) + canvas.getBoundingClientRect().x,
          clientY: plot.frame.py(w) + canvas.getBoundingClientRect().y });
        const send = (kind, v, w) => canvas.dispatchEvent(new PointerEvent(kind, at(v, w)));
        send("pointermove", 1, 1);
        send("pointerdown", 0.5, 0.5); send("pointermove", 2.1, 2.1); send("pointerup", 2.1, 2.1);
        out.after = { ...out }.brushed;
        send("pointerdown", 0.5, 0.5); send("pointerup", 0.5, 0.5);
        return out;""",
    )
    assert found == {"over": 1, "after": [1, 2], "brushed": None}


def test_numbers_that_do_not_fit_are_refused():
    with pytest.raises(ValueError, match=r"outside -32768 to 32767 steps of 0\.05"):
        packed([0.0, 1e4], "i2", grain=0.05)
    with pytest.raises(ValueError, match="outside"):
        packed([np.nan], "u1")
    with pytest.raises(ValueError, match="kind 'f2', expected one of f8"):
        packed([1.0], "f2")
    with pytest.raises(KeyError):
        scripted("none", {})


def test_a_page_has_only_the_parts_that_it_imports():
    text = scripted("view3d", {"a": "</script><!--"})
    names = re.findall(r"^const (\w+)_js = ", text, re.MULTILINE)
    assert names == ["camera", "normals", "painter", "gl_drawer", "view3d"]
    assert text.count("</script>") == 3
    assert "<!--" not in text
