"""Report pages: one self-contained HTML file each, nothing loaded from anywhere."""

import base64
import re
from pathlib import Path

from jinja2 import Environment, PackageLoader, StrictUndefined, select_autoescape

from report.effects import effect_title
from report.numbers import digits as digits
from report.numbers import percent, signed
from report.pages.contents import with_contents
from report.pages.tables import write_tables
from twin.files import write_whole
from twin.versions import versions

_APART = re.compile(r"(?<=[\d.]) (?=±|[µ%°]|min\b|h\b|mm\b|deg\b)|(?<=±) ")
"""Spaces between a number and its uncertainty or its unit."""


def write_page(path: str | Path, template: str, **content: object) -> None:
    """Render a template of `report/pages/templates` into one file, and its tables beside it.

    Args:
        path: The page; written whole or not at all.
        template: Name of the template, which extends `page.html`.
        content: What it shows; a missing name is our own mistake and raises.
    """
    environment = Environment(
        loader=PackageLoader("report.pages"),
        autoescape=select_autoescape(["html"]),
        undefined=StrictUndefined,
        trim_blocks=True,
        lstrip_blocks=True,
    )
    environment.filters |= {
        "digits": digits,
        "effect_title": effect_title,
        "percent": percent,
        "p_value": p_value,
        "unbroken": unbroken,
        "with_contents": with_contents,
    }
    environment.globals |= {"signed": signed, "picture": picture, "versions": versions}
    write_whole(path, environment.get_template(template).render(**content))
    write_tables(path)


def unbroken(words: str) -> str:
    """Words whose numbers stay on a line with their uncertainties and units.

    Example:
        >>> unbroken("lag 11.1 ± 0.5 min") == "lag 11.1\u00a0±\u00a00.5\u00a0min"
        True
    """
    return _APART.sub("\u00a0", words)


def picture(path: str | Path) -> str:
    """A PNG or SVG file as a data address, so that the page stands alone."""
    path = Path(path)
    kind = {".png": "image/png", ".svg": "image/svg+xml"}[path.suffix]
    return f"data:{kind};base64,{base64.b64encode(path.read_bytes()).decode('ascii')}"


def p_value(value: float) -> str:
    """A probability; what is beyond all doubt is not given more digits than it has."""
    return "< 1e-12" if value < 1e-12 else f"{value:.2g}"
