"""A page as PDF: by WeasyPrint where it is installed, else by a browser of this machine."""

import os
import shutil
import subprocess
from collections.abc import Callable
from functools import partial
from pathlib import Path

from matstd.twin.errors import DesignError, MissingLibrary
from matstd.twin.files import written_whole

BROWSERS = ("chromium", "chromium-browser", "google-chrome", "chrome", "msedge")
"""Names under which browsers that can print without a window are found."""

_PATIENCE = 300.0  # s; a design report of 8 MB takes a browser 5 s
Printer = Callable[[Path, Path], None]  # prints a page into an existing, empty PDF


def printer() -> Printer:
    """What prints pages, asked for before the work begins; raises MissingLibrary for nothing."""
    try:
        import weasyprint  # noqa: F401
    except (ImportError, OSError):  # OSError: it is here, the system library Pango is not
        browser = next(filter(None, map(shutil.which, BROWSERS)), None)
        if browser is None:
            raise MissingLibrary(
                "--pdf: neither WeasyPrint nor a browser found; expected one of them: "
                "pip install material-standard[pdf], or Chromium"
            ) from None
        return partial(_by_browser, browser)
    return _by_library


def write_pdf(page: Path, path: Path, printed_by: Printer) -> None:
    """Print a page; raises DesignError where the browser fails."""
    with written_whole(path) as part:
        printed_by(page.resolve(), part)


def _by_library(page: Path, part: Path) -> None:
    import logging

    from weasyprint import HTML

    logging.getLogger("weasyprint").setLevel(logging.ERROR)  # it remarks on every style it skips
    HTML(filename=str(page)).write_pdf(str(part))


def _by_browser(browser: str, page: Path, part: Path) -> None:
    options = ["--headless", "--disable-gpu", "--no-pdf-header-footer", f"--print-to-pdf={part}"]
    if getattr(os, "geteuid", int)() == 0 and os.name == "posix":
        options.append("--no-sandbox")  # no browser starts for root with one; the page is ours
    try:
        done = subprocess.run(
            [browser, *options, page.as_uri()],
            capture_output=True,
            text=True,
            timeout=_PATIENCE,
            check=False,
        )
    except (OSError, subprocess.TimeoutExpired) as error:
        raise DesignError(f"--pdf: {browser} did not print ({error})") from error
    if done.returncode or not part.stat().st_size:
        last = (done.stderr.strip().splitlines() or ["no message"])[-1]
        raise DesignError(f"--pdf: {browser} did not print ({last})")
