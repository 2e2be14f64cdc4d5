"""Table of contents of a page, made from its headings."""

import re

from markupsafe import Markup, escape

_HEADING = re.compile(r"<h2>(.*?)</h2>", re.S)
_TAG = re.compile(r"<[^>]+>")

FEWEST = 3
"""Sections from which a page has a table of contents."""


def with_contents(body: str) -> Markup:
    """The sections of a page with an address each, below a list of links to them.

    What stands before the first heading (verdict, key figures) stays before the list.

    Args:
        body: HTML whose sections begin with `<h2>`.

    Example:
        >>> print(with_contents("<p>Verdict.</p><h2>One</h2><h2>Two</h2><h2>Three</h2>")[:81])
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
