"""Lists of points with one row per coordinate, as in reports of CMMs.

Rows of one point share its name, or several columns together where one does not distinguish points
(a part and the number of its hole); otherwise the order of the rows decides.
"""

import re
from collections.abc import Sequence
from itertools import pairwise

from matstd.importers.sheets import Sheet

_VALUE = re.compile(r"\A(value|wert|valeur|reading|result|ergebnis)\Z", re.IGNORECASE)
"""Names of the column of measured values, where no clearer one exists."""
MIN_COMPLETE_SHARE = 2.0 / 3.0
"""If points have a smaller share of their coordinates, the order of the rows does not define points
(all X first, then all Y)."""


def letters_of_rows(sheet: Sheet) -> list[str] | None:
    """Letter of the coordinate that every row holds, "" of other rows; None where rows hold points.

    Most rows have one; of a report with diameters at least a third.
    """
    for i in range(len(sheet.columns)):
        named = [c.upper() if c.upper() in ("X", "Y", "Z") else "" for c in sheet.cells_as_text(i)]
        if 3 * sum(map(bool, named)) > len(named):
            sheet.used.add(i)
            return named
    return None


def nominal_and_measured(
    sheet: Sheet, nominal: re.Pattern[str], measured: re.Pattern[str]
) -> tuple[int, int]:
    """Columns of the two; raises BadFile where one is missing."""
    stated, found = sheet.find(nominal), sheet.find(measured)
    found = sheet.find(_VALUE) if found is None else found
    if stated is None or found is None:
        raise sheet.lacking("columns such as 'nominal' and 'measured'")
    return stated, found


def points_of_rows(
    sheet: Sheet, letters: Sequence[str], label: Sequence[str], setup: Sequence[str]
) -> tuple[list[str], list[dict[str, int]]]:
    """Name of the point of every row, and row of every coordinate of each point.

    Points of a name of their own are found wherever their rows stand; without, a point ends where
    its name changes or a letter comes again.
    """
    label = [_without_letter(n, c) for n, c in zip(label, letters, strict=True)]
    rows = [k for k, letter in enumerate(letters) if letter]
    points = _named(rows, label, setup, letters)
    if points is not None:
        return label, points
    points = _in_order(rows, label, letters)
    if MIN_COMPLETE_SHARE * len(points) * len({letters[k] for k in rows}) > len(rows):
        several = _several_names(sheet, rows, label, setup, letters)
        if several is not None:
            return several
    return label, points


def _named(
    rows: Sequence[int], label: Sequence[str], setup: Sequence[str], letters: Sequence[str]
) -> list[dict[str, int]] | None:
    """Points by their names; None where names do not distinguish them."""
    keys = [(setup[k], label[k], letters[k]) for k in rows]
    if not all(label[k] for k in rows) or len(set(keys)) < len(keys):
        return None
    points: dict[object, dict[str, int]] = {}
    for k in rows:
        points.setdefault((setup[k], label[k]), {})[letters[k]] = k
    return list(points.values())


def _in_order(
    rows: Sequence[int], label: Sequence[str], letters: Sequence[str]
) -> list[dict[str, int]]:
    """Points by the order of the rows."""
    points: list[dict[str, int]] = []
    for before, k in pairwise([-1, *rows]):
        if before < 0 or label[k] != label[before] or letters[k] in points[-1]:
            points.append({})
        points[-1][letters[k]] = k
    return points


def _several_names(
    sheet: Sheet,
    rows: Sequence[int],
    label: Sequence[str],
    setup: Sequence[str],
    letters: Sequence[str],
) -> tuple[list[str], list[dict[str, int]]] | None:
    """Names of points made of several columns that come again with every letter."""
    texts = {i: sheet.cells_as_text(i) for i in range(len(sheet.columns)) if i not in sheet.used}
    each = len({letters[k] for k in rows})
    # a name is equal in all rows of its point: a column over n points has at most n values
    names = [
        i for i, t in texts.items() if 1 < len({t[k] for k in rows}) <= len(rows) // max(each, 2)
    ]
    chosen: list[int] = []
    for i in names:
        chosen.append(i)
        parts = [texts[j] for j in chosen] + ([list(label)] if any(label) else [])
        full = ["-".join(p[k] for p in parts) for k in range(len(letters))]
        points = _named(rows, full, setup, letters)
        if points is not None and len(points) * each <= len(rows) + each:
            sheet.used.update(chosen)
            return full, points
    return None


def _without_letter(name: str, letter: str) -> str:
    """Name of a point from that of one of its coordinates: `X-Wert_Bohrung_01` is `Bohrung_01`."""
    if not letter:
        return name
    own = rf"(?<![a-z]){letter}(?:[-_ ]?(?:wert|value|val|coord\w*|koord\w*))?(?![a-z0-9])"
    return re.sub(own, "", name, flags=re.IGNORECASE).strip(" _.:-") or name
