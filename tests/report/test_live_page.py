"""The live page of a run in a real browser: its figures against fits, what a user does on it."""

import base64
import json
import re
from dataclasses import replace
from functools import partial

import numpy as np
import pytest
from browser import faults, numbers_of, opened, requests, run

from matstd.diagnosis.answer import compare
from matstd.diagnosis.choice import candidate_effects
from matstd.diagnosis.files import diagnosis_table
from matstd.diagnosis.fit import Prior, fit_run
from matstd.diagnosis.reduced import compared_board, diagnosed_board
from matstd.diagnosis.reduced.board import MOST_SWITCHES
from matstd.report.layout import Page, write_page
from matstd.report.run_view import Findings, Framed, diagnosis_view, run_view
from matstd.report.run_view.run_data import run_data
from matstd.report.run_view.touched_bodies import touched_bodies
from matstd.twin.library import ordinary_model
from matstd.twin.model import Model
from matstd.twin.numbers import significant
from matstd.twin.units import UM

pytestmark = pytest.mark.browser

SAME = 1e-7
"""Relative: figures of files have six digits, of which the last shall be the same."""

FIGURES = """const { fitted, heldOut } = livePage.shown.now;
    return [fitted, heldOut, document.getElementById("fitted").textContent,
      document.getElementById("held-out").textContent];"""
CLICK = """document.querySelector('input[data-effect="NAME"]').click();"""
ONLY = """for (const s of livePage.board.switches) s.isOn = NAMES.includes(s.name);
    const { columns } = livePage.board.columns(livePage.board.on);
    const { fitted, heldOut } = livePage.board.solver.errors(columns);
    return [fitted, heldOut];"""


def written(path, view):
    """A page of nothing but a view."""
    write_page(path, Page(heading="h", lead="l", key=(), sections=(), live=view))
    return path


@pytest.fixture(scope="module")
def page(warm, tmp_path_factory):
    path = tmp_path_factory.mktemp("live") / "report.html"
    return written(path, diagnosis_view(warm, "run.csv"))


@pytest.fixture
def live(browser, page):
    """The page, newly opened; it may not complain and not ask for anything."""
    opened(browser, page)
    yield browser
    assert faults(browser) == []
    assert requests(browser) == []


def test_switching_the_found_effect_moves_the_error_between_the_steps_of_the_file(live, warm):
    first, last = diagnosis_table(warm)["steps"]
    name = last["effect"]

    def is_as(step):
        fitted, held_out, *shown = run(live, FIGURES)
        assert [significant(fitted), significant(held_out)] == [step["rms_um"], step["test_rms_um"]]
        assert shown == [f"{step['rms_um']:.3f}", f"{step['test_rms_um']:.3f}"]

    is_as(last)
    run(live, CLICK.replace("NAME", name))
    is_as(first)
    run(live, CLICK.replace("NAME", name))
    is_as(last)
    # its size is the one that is reported
    words = run(live, "return document.querySelector('.amount').textContent")
    assert f"{last['parameters']['amplitude_um']:.2f}" in words


def test_sets_of_switches_are_as_fits_to_the_touches(live, warm):
    board, rng = diagnosed_board(warm), np.random.default_rng(1)
    fit, names = board.fit, [s.effect.name for s in board.switches]
    base = [e for e in fit.model.effects if e.name not in board.found]
    count = sum(len(e.parameters) for e in base)
    own = Prior(fit.prior.mean[:count], fit.prior.root[:count, :count], np.ones(count))
    for size in (1, 2, 4, 7):
        on = set(rng.choice(names, min(size, len(names)), replace=False).tolist())
        chosen = [s for s in board.switches if s.effect.name in on]
        prior = own
        for s in chosen:
            prior = prior.joined(Prior(np.zeros(len(s.sd)), np.diag(s.sd)))
        model = Model(fit.model.chain, (*base, *(s.effect for s in chosen)))
        known = fit_run(fit.run, model, prior, gross=fit.gross)
        figures = run(live, ONLY.replace("NAMES", json.dumps(sorted(on))))
        assert figures == pytest.approx([known.rms / UM, known.test_rms / UM], rel=SAME)


def test_residuals_are_those_of_the_fit_and_fall(live, warm):
    shown = np.array(run(live, "return [...livePage.shown.residual]"))
    assert shown == pytest.approx(warm.fit.residual / UM, abs=1e-3)
    run(live, CLICK.replace("NAME", warm.found[0].name))
    shown = np.array(run(live, "return [...livePage.shown.residual]"))
    assert shown == pytest.approx(warm.start.residual / UM, abs=2e-3)


def test_pulled_to_its_fitted_size_nothing_changes_and_pulled_to_nothing_it_is_off(live):
    before = run(live, "return livePage.shown.now.fitted")
    pull = """const one = livePage.board.on[0]; livePage.board.pull(one, GAIN); livePage.changed();
        return [livePage.shown.now.fitted, livePage.shown.now.heldOut];"""
    assert run(live, pull.replace("GAIN", "1"))[0] == pytest.approx(before, rel=1e-4)
    off = run(live, "return [...Object.values(livePage.data.known.find(k => !k.on.length))]")
    # the noise, and with it the weight of the prior, is found again as without it
    assert run(live, pull.replace("GAIN", "0")) == pytest.approx(off[1:], rel=1e-4)
    assert run(live, pull.replace("GAIN", "2"))[0] > 1.2 * before
    assert run(live, pull.replace("GAIN", "null"))[0] == pytest.approx(before, rel=1e-12)


def test_the_time_constant_has_its_best_place_where_it_was_found(live):
    move = """const range = document.querySelector("input[data-inner]");
        range.value = VALUE; range.dispatchEvent(new Event("input"));
        return [livePage.shown.now.fitted, livePage.board.on[0].value,
          Number(range.min), Number(range.max)];"""
    found = run(live, "return [livePage.shown.now.fitted, livePage.board.on[0].value]")
    low, high = run(live, move.replace("VALUE", "range.value"))[2:]
    places = np.linspace(low, high, 9)
    errors = [run(live, move.replace("VALUE", str(v)))[0] for v in places]
    assert min(errors) >= found[0] - 1e-5
    assert errors[0] > found[0] + 0.01
    assert run(live, move.replace("VALUE", str(np.log(found[1]))))[0] == pytest.approx(found[0])


def test_a_look_alike_takes_the_place_of_the_found_effect(live, warm):
    rival = run(live, "return livePage.board.switches[0].alike[0]")
    run(live, CLICK.replace("NAME", rival))
    assert run(live, "return livePage.board.on.map(s => s.name)") == [rival]
    run(live, "document.getElementById('again').click()")
    assert run(live, "return livePage.board.on.map(s => s.name)") == [warm.found[0].name]


def test_touches_are_pointed_at_chosen_and_listed(live, warm):
    live.execute_script("livePage.touched.view.draw()")
    hit = """const { view, dots } = livePage.touched, t = livePage.data.touches, out = [];
        for (let i = 0; i < t.count && out.length < 3; i += 7) {
          const [x, y] = view.project([0, 1, 2].map(k => t.point.values[3 * i + k]));
          const found = view.pick(x, y);
          if (found && found.layer === dots && found.index === i) out.push([i, x, y]);
        }
        return out;"""
    (i, x, y), *_ = run(live, hit)
    send = """livePage.touched.canvas.dispatchEvent(new PointerEvent("KIND", { bubbles: true,
        clientX: X + livePage.touched.canvas.getBoundingClientRect().x,
        clientY: Y + livePage.touched.canvas.getBoundingClientRect().y }));
        return [document.querySelector(".tip").textContent, livePage.shown.marked];"""
    send = send.replace("X +", f"{x} +").replace("Y +", f"{y} +")
    words, marked = run(live, send.replace("KIND", "pointermove"))
    assert marked == i
    run_, fit = warm.run, warm.fit
    assert f"line {run_.line[i]}," in words
    assert str(run_.touches.feature[i]) in words
    assert f"{fit.residual[i] / UM:+.2g}"[:4] in words.replace("−", "-")
    run(live, "livePage.choose([3, 4, 5])")
    rows = run(live, "return document.querySelectorAll('#chosen tbody tr').length")
    assert rows == 3
    title = run(live, "return document.querySelector('#chosen h3').textContent")
    rms = np.sqrt(np.mean((fit.residual[3:6] / UM) ** 2))
    assert title.startswith("3 touches chosen")
    assert float(title.split(",")[1].split()[0]) == pytest.approx(rms, rel=0.01)
    run(live, "livePage.choose(null)")
    assert run(live, "return document.getElementById('chosen').textContent") == ""


def test_a_touch_has_the_line_of_its_program(browser, warm, tmp_path):
    """Rows of a program, of a program whose text was not at hand, and rows without a program."""
    known = warm.fit.run
    count = len(known)
    program = np.array(["MS_A_1", "MS_A_2", ""])[np.arange(count) % 3]
    number = np.where(program == "", 0, np.arange(count) + 10)
    line = np.where(program == "MS_A_1", 7 * number, 0)
    stated = replace(known, program=program, touch=number, program_line=line)
    board = diagnosed_board(replace(warm, steps=(*warm.steps[:1],), candidates=()))
    board = replace(board, fit=replace(board.fit, run=stated))
    opened(browser, written(tmp_path / "program.html", run_view(board, Findings("run.csv"))))
    tip = "livePage.mark(ROW); return document.querySelector('.tip').textContent"
    first, second, third = (run(browser, tip.replace("ROW", str(k))) for k in (3, 4, 5))
    assert f"line {known.line[3]}, set-up" in first
    assert "; MS_A_1 touch 13, line 91; " in first
    assert "; MS_A_2 touch 14; " in second
    assert "MS_A" not in third
    run(browser, "livePage.choose([3, 4])")
    column = "document.querySelectorAll('#chosen tr > :nth-child(2)')"
    cells = f"return [...{column}].map(e => e.textContent)"
    assert run(browser, cells) == ["program", "MS_A_1 touch 13, line 91", "MS_A_2 touch 14"]
    assert faults(browser) == []


def test_the_true_body_stands_behind_the_touches(warm):
    """With a body of the user it is that, to the grain of the page; without, what was touched."""
    board, cube = diagnosed_board(warm), np.arange(36.0).reshape(4, 3, 3) * 5.0
    data = run_data(board, Findings("run.csv", body=cube))
    body = data["body"]
    assert unpacked(body) * body["grain"] == pytest.approx(cube.reshape(-1), abs=body["grain"])
    without = run_data(board, Findings("run.csv"))
    assert without["body"]["shape"][0] > 36


def test_keys_and_labels_suffice(live):
    from selenium.webdriver.common.keys import Keys

    box = live.find_element("css selector", "#effect-list input[type=checkbox]")
    box.send_keys(Keys.SPACE)
    said = run(live, "return document.querySelector('.ladder').getAttribute('aria-label')")
    assert said.startswith("starting model: fitted")
    assert "held out" in said
    unnamed = run(
        live,
        """const kinds = ["input", "select", "button", "canvas"].map(k => `#live ${k}`).join();
        return [...document.querySelectorAll(kinds)]
          .filter(e => !(e.labels && e.labels.length) && !e.getAttribute("aria-label")
            && !e.textContent.trim()).map(e => e.outerHTML.slice(0, 80))""",
    )
    assert unnamed == []
    run(live, "document.getElementById('theme').click()")
    ground = run(live, "return getComputedStyle(document.body).backgroundColor")
    assert ground == "rgb(20, 24, 29)"


def test_the_page_fits_every_width(live):
    for width in (800, 1280, 2560):
        live.set_window_size(width, 900)
        wide, inner = run(live, "return [document.documentElement.scrollWidth, innerWidth]")
        assert wide <= inner, width
    live.set_window_size(1280, 800)


def changed(run_, **values):
    return replace(run_, touches=replace(run_.touches, **values))


def one_touch_a_feature(run_):
    return changed(run_, feature=np.array([f"f{i}" for i in range(len(run_))]))


def without_poses(run_):
    return changed(run_, pose=np.zeros(len(run_), dtype=np.int64))


def without_places(run_):
    n = len(run_)
    return changed(run_, point=np.ones((n, 3)), normal=np.tile([0.0, 0.0, 1.0], (n, 1)))


def along_one_axis(run_):
    """As of a laser: points on a line that does not pass the origin."""
    point = np.column_stack([np.linspace(0.0, 400.0, len(run_)), *np.full((2, len(run_)), 300.0)])
    return changed(run_, point=point, normal=np.tile([1.0, 0.0, 0.0], (len(run_), 1)))


def with_an_empty_column(run_):
    return changed(run_, value={"coolant_l_min": np.full(len(run_), np.nan)})


def held_out(run_):
    return replace(run_, split=np.where(run_.touches.pose % 4 == 1, "test", "train"))


@pytest.mark.parametrize(
    "odd",
    [
        with_an_empty_column,
        pytest.param(one_touch_a_feature, marks=pytest.mark.slow),
        pytest.param(without_poses, marks=pytest.mark.slow),
        pytest.param(without_places, marks=pytest.mark.slow),
        pytest.param(along_one_axis, marks=pytest.mark.slow),
        pytest.param(held_out, marks=pytest.mark.slow),
    ],
    ids=lambda f: f.__name__,
)
def test_odd_runs_are_shown_as_far_as_they_go(odd, browser, warm, tmp_path):
    found = compare(odd(warm.run[::5]), ordinary_model(warm.run.touches.chain))
    view = run_view(compared_board(found), Findings("odd.csv"))
    opened(browser, written(tmp_path / "odd.html", view))
    fitted, held, *_ = run(browser, FIGURES)
    assert [fitted, held] == pytest.approx([found.fit.rms / UM, found.fit.test_rms / UM])
    # what lies in space is in the middle of the picture; readings at one place have none
    seen = run(
        browser,
        """const { view } = livePage.touched, { point, count } = livePage.data.touches, out = [];
        for (let i = 0; i < count; i++) {
          out.push(view.project([...point.values.subarray(3 * i, 3 * i + 3)]));
        }
        return [view.canvas.clientWidth, view.canvas.clientHeight, out];""",
    )
    assert (
        bool(seen[0])
        == run_data(compared_board(found), Findings("odd.csv"))["touches"]["isSpread"]
        == (odd is not without_places)
    )
    if seen[0]:
        places = np.array(seen[2])
        assert (places.min(axis=0) > 0.0).all()
        assert (places.max(axis=0) < seen[:2]).all()
        assert (places.min(axis=0) + places.max(axis=0)) / 2.0 == pytest.approx(
            np.array(seen[:2]) / 2.0, rel=0.25
        )
    assert faults(browser) == []


def test_no_effect_at_all(browser, warm, tmp_path):
    board = diagnosed_board(replace(warm, steps=warm.steps[:1], candidates=()))
    assert board.switches == ()
    opened(browser, written(tmp_path / "none.html", run_view(board, Findings("none.csv"))))
    said = run(browser, "return document.getElementById('effect-list').textContent")
    assert "no effect that these touches could show" in said
    assert faults(browser) == []


def numbers(tree):
    """Every packed array of a page's data, by its path."""
    if isinstance(tree, dict) and "base64" in tree:
        return {"": tree}
    pairs = tree.items() if isinstance(tree, dict) else enumerate(tree)
    return {
        f"{key}.{path}": found
        for key, part in pairs
        if isinstance(part, dict | list)
        for path, found in numbers(part).items()
    }


def unpacked(one):
    """Numbers of a packed array."""
    return numbers_of(base64.b64decode(one["base64"]), one["kind"])


def test_of_hundreds_of_effects_fifteen_are_offered(warm):
    run_ = warm.run[::4]
    assert len(candidate_effects(run_.touches)) > 200
    board = compared_board(compare(run_, ordinary_model(run_.touches.chain)))
    assert 5 < len(board.switches) <= MOST_SWITCHES


def test_data_of_odd_runs_hold_numbers_wherever_the_page_computes_with_them(warm):
    """Twelve touches, no poses, one touch a feature, nothing but NaN in two columns."""
    few = warm.run[:: len(warm.run) // 12]
    count = len(few)
    odd = changed(
        few,
        pose=np.zeros(count, dtype=np.int64),
        feature=np.array([f"f{i}" for i in range(count)]),
        value={k: np.full(count, np.nan) for k in ("coolant_l_min", "hall_degC")},
    )
    found = compare(odd, ordinary_model(odd.touches.chain))
    data = run_data(compared_board(found), Findings("odd.csv"))
    arrays = numbers(data)
    assert arrays["touches.point."]["shape"] == [count, 3]
    for path, one in arrays.items():
        if not path.startswith("columns"):
            assert np.all(np.isfinite(unpacked(one))), path


def test_what_was_touched_is_drawn_from_its_points(warm):
    """Corners of a ball lie on it; those of a face on its points."""
    t = warm.run.touches
    bodies = touched_bodies(t)
    assert len(bodies) == len(set(t.feature.tolist()))
    near = partial(np.linalg.norm, axis=-1)
    for name, body in zip(dict.fromkeys(t.feature.tolist()), bodies, strict=True):
        own = t.point[t.feature == name]
        away = near(body.reshape(-1, 1, 3)[:: len(body) // 20 + 1] - own).min(axis=1)
        assert away.max() < 25.0


def test_in_a_notebook_the_view_stands_in_a_frame(browser, warm, tmp_path):
    framed = Framed("run.csv", "One effect is missing.", diagnosis_view(warm, "run.csv"))
    path = tmp_path / "notebook.html"
    path.write_text(f"<!DOCTYPE html><title>n</title>{framed._repr_html_()}", encoding="utf-8")
    opened(browser, path, frame=0)
    held_out = warm.fit.test_rms / UM
    assert run(browser, FIGURES)[1] == pytest.approx(held_out)
    browser.switch_to.default_content()
    assert faults(browser) == []
    assert framed.save(tmp_path / "alone.html").read_text(encoding="utf-8") == framed.page


def test_without_scripts_and_in_print_the_still_report_is_whole(browser, page):
    """The view is hidden until its script fills it; what is folded by the script opens in print."""
    text = page.read_text(encoding="utf-8")
    assert re.search(r'<section id="live"[^>]* hidden', text)
    assert '<details class="still" open>' in text
    opened(browser, page)
    still = "return [document.querySelector('details.still').open, LIVE]"
    seen = "getComputedStyle(document.getElementById('live')).display"
    assert run(browser, still.replace("LIVE", seen)) == [False, "grid"]
    run(browser, "dispatchEvent(new Event('beforeprint'))")
    browser.execute_cdp_cmd("Emulation.setEmulatedMedia", {"media": "print"})
    assert run(browser, still.replace("LIVE", seen)) == [True, "none"]
    browser.execute_cdp_cmd("Emulation.setEmulatedMedia", {"media": ""})
