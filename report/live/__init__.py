"""Pages that move: data and scripts in one HTML file that loads nothing.

Python packs numbers as typed arrays with their units (`packed`); scripts are plain ES modules:
`parts` are shared (view in three dimensions, plots, ladder, sliders, colours), `pages` have one
module for each kind of page. `scripted` puts the data, the module of the page and every part that
it imports into the text of one file, which a browser opens from a disk or a mail.
"""

from matstd.report.live.embed import TREE, packed, scripted, style

__all__ = ["TREE", "packed", "scripted", "style"]
