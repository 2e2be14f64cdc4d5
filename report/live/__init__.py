"""Pages that move: data and scripts in one HTML file that loads nothing.

Python packs numbers as typed arrays with their units (`packed`); scripts are plain ES modules:
`parts` are shared (view in three dimensions, plots, ladder, sliders, colours), `pages` have one
module for each kind of page. `scripted` puts the data, the module of the page and every part that
it imports into the text of one file, which a browser opens from a disk or a mail. A module loaded
from a disk may import no other file: so the modules stand in one script, each a function with names
of its own, in an order in which every one finds those that it imports.
"""

import base64
import json
import re
import zlib
from functools import cache
from importlib.resources import files
from typing import Any

import numpy as np
from markupsafe import Markup
from numpy.typing import ArrayLike, NDArray

from matstd.twin.words import in_own_unit

TREE = dict[str, Any]  # what JSON holds, with packed arrays

_KINDS = ("f8", "f6", "f4", "f3", "i4", "u4", "i2", "u2", "i1", "u1")
_IMPORT = re.compile(r'^import (\{[^}]*\}|\* as \w+) from "\.{1,2}/(?:parts/)?(\w+)\.js";', re.M)
_EXPORT = re.compile(r"^export (?=(?:async )?(?:function|class|const) (\w+))", re.M)
_FOLDERS = ("parts", "pages")


def packed(
    values: ArrayLike, kind: str = "f4", *, unit: str = "", name: str = "", grain: float = 1.0
) -> TREE:
    """An array as the scripts unpack it (`parts/data.js`).

    Args:
        values: Numbers of any shape; for kinds of whole numbers they must be finite.
        kind: `f8`, `f4`, or the upper bytes of the former alone, `f6` (11 digits) and `f3` (3
            digits); or of whole numbers `i4`, `u4`, `i2`, `u2`, `i1`, `u1`.
        grain: What one step of a whole number is; values are rounded to it.

    Raises:
        ValueError: A kind that there is none of, or numbers that do not fit into it.
    """
    if kind not in _KINDS:
        raise ValueError(f"kind {kind!r}, expected one of {', '.join(_KINDS)}")
    array = np.asarray(values)
    if kind[0] != "f":
        steps = np.rint(np.asarray(array, dtype=np.float64) / grain)
        limits = np.iinfo(kind)
        if not np.all((steps >= limits.min) & (steps <= limits.max)):
            raise ValueError(f"numbers outside {limits.min} to {limits.max} steps of {grain}")
        array = steps
    data = _bytes(array, kind)
    return {
        "kind": kind,
        "shape": list(array.shape),
        "unit": in_own_unit(unit),
        "name": name,
        "grain": grain,
        "base64": _base64(data),
    }


def _bytes(array: NDArray[np.generic], kind: str) -> bytes:
    """Numbers as a kind keeps them, the lowest byte first."""
    if kind not in ("f6", "f3"):
        return np.ascontiguousarray(array, dtype=f"<{kind}").tobytes()
    kept = int(kind[1])
    whole = np.ascontiguousarray(array, dtype="<f8").reshape(-1).view("<u8")
    half = np.uint64(1 << (8 * (8 - kept) - 1))
    return (whole + half).view("u1").reshape(-1, 8)[:, 8 - kept :].tobytes()


def scripted(page: str, data: TREE) -> Markup:
    """Elements that make a page move: its data and its script with all parts that this imports.

    Args:
        page: Name of a module in `report/live/pages`, without `.js`.
        data: For `pageData()`; JSON with packed arrays.

    Raises:
        KeyError: No such module.
    """
    modules = "\n".join(_modules(page))
    assert "</script" not in modules, page
    arrays: list[bytes] = []
    tree = _apart(data, arrays)
    return Markup(
        '<script type="application/json" id="live-data">{}</script>\n'
        '<script type="application/octet-stream" id="live-arrays">{}</script>\n'
        '<script type="module">\n{}document.documentElement.dataset.isReady = "true";\n</script>\n'
    ).format(_json(tree), _base64(zlib.compress(b"".join(arrays))), Markup(modules))


def _apart(tree: Any, arrays: list[bytes]) -> Any:
    """A tree with its packed arrays taken out: in their place stands where they begin in a row.

    All of them compressed together take half of the room: look-alike effects have like matrices.
    """
    if isinstance(tree, list | tuple):
        return [_apart(part, arrays) for part in tree]
    if not isinstance(tree, dict):
        return tree
    if "base64" not in tree:
        return {key: _apart(part, arrays) for key, part in tree.items()}
    arrays.append(base64.b64decode(tree["base64"]))
    kept = {key: part for key, part in tree.items() if key != "base64"}
    return {**kept, "from": sum(map(len, arrays[:-1])), "bytes": len(arrays[-1])}


def _base64(data: bytes) -> str:
    return base64.b64encode(data).decode("ascii")


def style() -> Markup:
    """The style sheet of everything that the parts make, with its colours, light and dark."""
    return Markup("<style>\n{}</style>").format(Markup(_text("parts", "live.css")))


def _json(tree: TREE) -> Markup:
    text = json.dumps(tree, allow_nan=False, separators=(",", ":"))
    # nothing in a script element may look like its end, or like a comment
    return Markup(text.replace("<", "\\u003c"))


def _modules(page: str) -> list[str]:
    """A module behind all that it imports, each as a function of its own."""
    found: dict[str, str] = {}

    def visit(name: str) -> None:
        text = _sources()[name]
        for _, other in _IMPORT.findall(text):
            if other not in found:
                visit(other)
        exported = ", ".join(_EXPORT.findall(text))
        body = _EXPORT.sub("", _IMPORT.sub(_bound, text))
        found[name] = (
            f"const {name}_js = await (async () => {{\n{body}return {{ {exported} }};\n}})();\n"
        )

    visit(page)
    return list(found.values())


def _bound(match: re.Match[str]) -> str:
    """An import as names of a module that stands above."""
    names, module = match.groups()
    return f"const {names.removeprefix('* as ').replace(' as ', ': ')} = {module}_js;"


@cache
def _sources() -> dict[str, str]:
    """Every module of this part, by name: names of files are unique."""
    found = {}
    for folder in _FOLDERS:
        place = files("matstd.report.live") / folder
        for file in sorted(place.iterdir() if place.is_dir() else (), key=lambda f: f.name):
            if file.name.endswith(".js"):
                assert file.name not in found, file.name
                found[file.name] = file.read_text(encoding="utf-8")
    return {name.removesuffix(".js"): text for name, text in found.items()}


def _text(folder: str, file: str) -> str:
    return (files("matstd.report.live") / folder / file).read_text(encoding="utf-8")
