"""Draws docs/gallery/*.png: live pages as Chromium shows them; needs the packages of the tests.

python docs/draw_gallery.py [diagnose compare machine program]
"""

import io
import sys
import tempfile
import time
from collections.abc import Callable
from pathlib import Path
from typing import Any

ROOT = Path(__file__).resolve().parents[1]
FOLDER = ROOT / "docs" / "gallery"
RUN = ROOT / "examples" / "hidden_effect" / "warm_up.csv"
MACHINE = ROOT / "examples" / "hsm600u-machine.toml"
WIDTH, HEIGHT = 1280, 800

sys.path.append(str(ROOT / "tests" / "fixtures"))


def diagnosed(folder: Path) -> Path:
    """A diagnosis with what it found."""
    import matstd

    matstd.diagnose(RUN, auto=True).live().save(folder / "page.html")
    return folder / "page.html"


def compared(folder: Path) -> Path:
    """A comparison, with nothing switched on."""
    import matstd

    matstd.compare(RUN).live().save(folder / "page.html")
    return folder / "page.html"


def machine(folder: Path) -> Path:
    """A machine with all its errors."""
    import matstd

    matstd.show(MACHINE).save(folder / "page.html")
    return folder / "page.html"


def program(folder: Path) -> Path:
    """A machine that plays a probing program."""
    import matstd

    played = ROOT / "tests" / "golden" / "programs" / "MS_A_1.H"
    matstd.show(MACHINE, program=played).save(folder / "page.html")
    return folder / "page.html"


ALL_ON = """const every = [...document.querySelectorAll("button")];
every.find(b => b.textContent === "on").click();
const factor = [...document.querySelectorAll(".slider")].find(s => /factor/.test(s.textContent));
const range = factor.querySelector("input");
range.value = 1; range.dispatchEvent(new Event("input"));"""
"""Every error that a machine can have, in the size expected of its class."""

LATER = """const time = [...document.querySelectorAll("input[type=range]")]
  .find(r => /time/i.test(r.getAttribute("aria-label") || ""));
time.value = 0.45 * time.max; time.dispatchEvent(new Event("input"));"""

PAGES: dict[str, tuple[Callable[[Path], Path], str]] = {
    "diagnose": (diagnosed, ""),
    "compare": (compared, ""),
    "machine": (machine, ALL_ON),
    "program": (program, ALL_ON + LATER),
}
"""What makes a page, and what is done on it before it is drawn."""


def drawn(driver: Any, page: Path, doing: str, to: Path) -> None:
    """The picture of a page, with a palette."""
    from PIL import Image

    size = {"width": WIDTH, "height": HEIGHT, "deviceScaleFactor": 1, "mobile": False}
    driver.execute_cdp_cmd("Emulation.setDeviceMetricsOverride", size)
    driver.get(page.as_uri())
    driver.execute_script(doing)
    time.sleep(4.0)  # a software renderer takes its time
    seen = Image.open(io.BytesIO(driver.get_screenshot_as_png())).convert("RGB")
    seen.quantize(256, method=Image.Quantize.FASTOCTREE).save(to, optimize=True)
    print(f"{to.relative_to(ROOT)}: {to.stat().st_size / 1e3:.0f} kB")


def main(names: list[str]) -> None:
    """All pictures, or those named."""
    from browser import started

    FOLDER.mkdir(exist_ok=True)
    driver = started(WIDTH, HEIGHT)
    try:
        for name in names or PAGES:
            make, doing = PAGES[name]
            with tempfile.TemporaryDirectory() as folder:
                drawn(driver, make(Path(folder)), doing, FOLDER / f"{name}.png")
    finally:
        driver.quit()


if __name__ == "__main__":
    main(sys.argv[1:])
