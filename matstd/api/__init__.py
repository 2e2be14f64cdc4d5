"""The functions behind the names of `matstd`: each strings rooms together for one purpose.

Commands call them too; they read options, call, print and exit. A function takes records or the
paths of files, in base units (mm, rad, s, °C), and gives a result that can be printed, saved and
looked at in a notebook. `matstd.__init__` lists which module has which name.
"""

from matstd.twin.display import before_showing


def _register_displays() -> None:
    """Sentences and pictures of results live in the report, which takes a second to load."""
    import matstd.report.pages  # noqa: F401


before_showing(_register_displays)
