"""Live pages in Firefox from a disk: figures, switches, touches, the machine; without WebGL."""

import pytest

from matstd.diagnosis.answer import compare
from matstd.diagnosis.reduced import compared_board
from matstd.report.layout import Page, write_page
from matstd.report.machine import ShownMachine, machine_html
from matstd.report.run_view import Findings, run_view
from matstd.twin.library import ordinary_model
from matstd.twin.units import UM

pytestmark = [pytest.mark.browser, pytest.mark.slow]  # Chromium is driven in every run

FIGURES = "const { fitted, heldOut } = livePage.shown.now; return [fitted, heldOut]"
POINTED = """const { view, dots } = livePage.touched, t = livePage.data.touches;
    view.draw();
    for (let i = 0; i < t.count; i++) {
      const [x, y] = view.project([...t.point.values.subarray(3 * i, 3 * i + 3)]);
      const found = view.pick(x, y);
      if (!found || found.layer !== dots || found.index !== i) continue;
      const box = view.canvas.getBoundingClientRect();
      view.canvas.dispatchEvent(new PointerEvent("pointermove",
        { bubbles: true, clientX: x + box.x, clientY: y + box.y }));
      return [i, livePage.shown.marked, document.querySelector(".tip").textContent];
    }"""


def test_a_run(firefox, case, tmp_path):
    """Figures of the command; a switch lowers the error; a touch is pointed at."""
    run = case(31, "hsm600u", ("thermal-lag(EZZ)",), True, (30.0, 35.0)).run[::4]
    found = compare(run, ordinary_model(run.touches.chain))
    view = run_view(compared_board(found), Findings("run.csv"))
    path = tmp_path / "report.html"
    write_page(path, Page(heading="h", lead="l", key=(), sections=(), live=view))
    firefox.opened(path)
    known = [found.fit.rms / UM, found.fit.test_rms / UM]
    assert firefox.run(FIGURES) == pytest.approx(known, rel=1e-12)
    firefox.run("document.querySelector('#effect-list input').click()")
    assert firefox.run(FIGURES)[0] < known[0]
    row, marked, words = firefox.run(POINTED)
    assert row == marked
    assert f"line {run.line[row]}," in words
    assert firefox.faults() == []
    assert firefox.requests() == []


def test_a_machine(firefox, chain, tmp_path):
    """A slider of a linear axis of the tool moves the tool point by as much."""
    path = tmp_path / "machine.html"
    shown = ShownMachine(chain=chain, length=150.0, duration=0.0)
    path.write_text(machine_html(shown), encoding="utf-8")
    firefox.opened(path)
    height = "return Number(document.getElementById('nominal-z').textContent.replace('−', '-'))"
    before = firefox.run(height)
    low, high = chain.link("Z").range
    move = "range.value = {}; range.dispatchEvent(new Event('input'))"
    firefox.run(f"const range = document.getElementById('axis-Z'); {move.format(low + 100.0)}")
    assert firefox.run(height) - before == pytest.approx(low + 100.0 - min(0.0, high))
    assert firefox.faults() == []
    assert firefox.requests() == []
