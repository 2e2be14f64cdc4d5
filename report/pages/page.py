"""Report pages: one self-contained HTML file each, nothing loaded from anywhere."""

import base64
import re
from pathlib import Path

from jinja2 import Environment, PackageLoader, StrictUndefined, select_autoescape
from markupsafe import Markup, escape

from matstd.report.effects import effect_title
from matstd.report.numbers import digits as digits
from matstd.report.numbers import percent, signed
from matstd.report.pages.tables import write_tables
from matstd.twin.files import write_whole
from matstd.twin.versions import versions
from matstd.twin.words import in_own_unit

_MINUS = re.compile(r"(?<![^\s(,])-(?=\d)")
_APART = re.compile(r"(?<=[\d.]) (?=±|[µ%°]|min\b|h\b|mm\b|deg\b)|(?<=±) ")
"""Spaces between a number and its uncertainty or its unit."""

_HEADING = re.compile(r"<h2>(.*?)</h2>", re.S)
_TAG = re.compile(r"<[^>]+>")

FEWEST = 3
"""Sections from which a page has a table of contents."""


def write_page(path: str | Path, template: str, **content: object) -> None:
    """Render a template of `report/pages/templates` into one file, and its tables beside it.

    Args:
        path: The page; written whole or not at all.
        template: Name of the template, which extends `page.html`.
        content: What it shows; a missing name is our own mistake and raises.
    """
    environment = Environment(
        loader=PackageLoader("matstd.report.pages"),
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
        "opening": opening,
        "unbroken": unbroken,
        "with_contents": with_contents,
    }
    environment.globals |= {"signed": signed, "picture": picture, "versions": versions}
    write_whole(path, in_own_unit(environment.get_template(template).render(**content)))
    write_tables(path)


def opening(words: str) -> str:
    """Words at the beginning of a sentence; names of columns keep their small letter.

    Example:
        >>> opening("touches scatter"), opening("time_s is 0")
        ('Touches scatter', 'time_s is 0')
    """
    return words if "_" in words.split(" ", 1)[0] else words[:1].upper() + words[1:]


def unbroken(words: str) -> str:
    """Words whose numbers stay on a line with their uncertainties and units, minus signs as such.

    Example:
        >>> unbroken("X -3 to 5") == "X \u22123 to 5"
        True
        >>> unbroken("lag 11.1 ± 0.5 min") == "lag 11.1\u00a0±\u00a00.5\u00a0min"
        True
    """
    return _APART.sub("\u00a0", _MINUS.sub("\u2212", words))


def picture(path: str | Path) -> str:
    """A PNG or SVG file as a data address, so that the page stands alone."""
    path = Path(path)
    kind = {".png": "image/png", ".svg": "image/svg+xml"}[path.suffix]
    return f"data:{kind};base64,{base64.b64encode(path.read_bytes()).decode('ascii')}"


def p_value(value: float) -> str:
    """A probability; what is beyond all doubt is not given more digits than it has."""
    return "< 1e-12" if value < 1e-12 else f"{value:.2g}"


def with_contents(body: str) -> Markup:
    """The sections of a page with an address each, below a list of links to them.

    What stands before the first heading (verdict, key figures) stays before the list.

    Args:
        body: HTML whose sections begin with `<h2>`.

    Example:
        >>> print(with_contents("<p>Verdict.</p><h2>One</h2><h2>Two</h2><h2>Three</h2>")[:78])
        <p>Verdict.</p><nav aria-label="Contents"><ol>
        <li><a href="#one">One</a></li>
    """
    titles = [_TAG.sub("", title).strip() for title in _HEADING.findall(body)]
    addresses = [re.sub(r"[^a-z0-9]+", "-", title.lower()).strip("-") for title in titles]
    if len(set(addresses)) < len(addresses):
        addresses = [f"{address}-{k}" for k, address in enumerate(addresses)]
    todo = iter(addresses)
    named = _HEADING.sub(lambda found: f'<h2 id="{next(todo)}">{found[1]}</h2>', body)
    if len(titles) < FEWEST:
        return Markup(named)  # our own template, escaped where it was filled
    links = "\n".join(
        f'<li><a href="#{address}">{escape(Markup(title))}</a></li>'
        for address, title in zip(addresses, titles, strict=True)
    )
    head, first, rest = named.partition("<h2 ")
    return Markup(f'{head}<nav aria-label="Contents"><ol>\n{links}\n</ol></nav>\n{first}{rest}')
