"""A sheet of paper in millimetres, and the signs of technical drawings on it."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from matstd.report.style import figure
from matstd.twin.frames import Array


@dataclass(frozen=True, slots=True)
class Paper:
    """A format of ISO 5457, lying; mm."""

    name: str
    width: float
    height: float

    @property
    def size(self) -> tuple[float, float]:
        """Width and height, mm."""
        return self.width, self.height


A2, A1, A0 = Paper("A2", 594.0, 420.0), Paper("A1", 841.0, 594.0), Paper("A0", 1189.0, 841.0)
PAPERS = (A2, A1, A0)  # papers of drawings, the smallest first
WIDE, THIN = 0.5, 0.25  # lines of ISO 128-2, mm
HATCH = "hatch"  # filling of a cut solid (ISO 128-3)
LETTER_HEIGHT = 2.5  # height of lettering, mm (ISO 3098-1); smaller letters do not survive a copy
ROW = 5.2  # height of a row of a table, mm
_POINT = 72.0 / 25.4  # points a millimetre
_MARGIN, _BINDING = 10.0, 20.0
_FIELD, _GRID = 50.0, 5.0  # mm: length and width of a reference field in the border (ISO 5457)
_ARROW = 2.6  # mm
_WIDE, _NARROW = 0.95, 0.84  # of its height, a capital and any other letter with its space
_CLEAR, _WAYS = 1.0, 32  # mm between a circle and its name; directions that are tried for it


@dataclass(frozen=True, slots=True)
class View:
    """Where a view lies on the sheet."""

    x: float  # place of the view's origin, mm of paper
    y: float  # the same upwards, mm of paper
    scale: float  # paper by part

    def at(self, points: Any) -> Array:
        """Points (N, 2) of the view on paper, mm."""
        return np.array([self.x, self.y]) + self.scale * np.atleast_2d(points)


@dataclass(frozen=True, slots=True)
class Block:
    """Something that may stand anywhere on a sheet."""

    width: float  # mm of paper
    height: float  # the same
    # draws it on a sheet, from the x of its left and the y of its upper edge
    draw: "Callable[[Sheet, float, float], None]"


def block_of(scale: float, draw: "Callable[[Sheet, View], None]") -> Block:
    """A drawn section as a block, as large as what it draws."""
    scratch = Sheet()
    begin = len(scratch.ink)
    draw(scratch, View(0.0, 0.0, scale))
    points = np.concatenate(scratch.ink[begin:])
    (x0, y0), (x1, y1) = points.min(axis=0), points.max(axis=0)

    def place(sheet: Sheet, x: float, top: float) -> None:
        draw(sheet, View(x - x0, top - y1, scale))

    return Block(float(x1 - x0), float(y1 - y0), place)


def ratio(scale: float) -> str:
    """A scale as ISO 5455 writes it."""
    return f"{scale:g}:1" if scale >= 1.0 else f"1:{np.round(1.0 / scale, 2):g}"


class Sheet:
    """Lines and signs, all in millimetres of paper from the lower left corner."""

    def __init__(self, paper: Paper = A2) -> None:
        self.paper = paper
        wide, high = paper.width, paper.height
        self.figure = figure(high / 25.4, wide / 25.4, layout=None)
        self.axes = self.figure.add_axes((0.0, 0.0, 1.0, 1.0))
        self.axes.set(xlim=(0.0, wide), ylim=(0.0, high))
        self.axes.set_axis_off()
        self._depth = 1.0
        self.ink: list[Array] = []  # points of everything drawn
        self._points, self._lines = np.empty((0, 2)), 0  # of how many of its lines
        # edges of the drawing space
        self.left, self.right = _BINDING, wide - _MARGIN
        self.low, self.high = _MARGIN, high - _MARGIN
        self.box(self.left, self.low, self.right - self.left, self.high - self.low, 0.7)
        self._border()

    def _border(self) -> None:
        """Reference fields and centring marks of ISO 5457."""
        across, along = 0.5 * (self.left + self.right), 0.5 * (self.low + self.high)
        count = 2 * int((self.right - across) / _FIELD)
        for k in range(count + 1):
            x = across + (k - count / 2) * _FIELD
            for y, out in ((self.low, -1.0), (self.high, 1.0)):
                self.line([[x, y], [x, y + out * _GRID]], 0.35)
                if k < count:
                    middle = y + 0.5 * out * _GRID - 1.2
                    self.text(x + 0.5 * _FIELD, middle, f"{k + 1}", ha="center")
        count = 2 * int((self.high - along) / _FIELD)
        for k in range(count + 1):
            y = along + (count / 2 - k) * _FIELD
            for x, out in ((self.left, -1.0), (self.right, 1.0)):
                self.line([[x, y], [x + out * _GRID, y]], 0.35)
                if k < count:
                    letter = "ABCDEFGHJKLMNPQR"[k]
                    self.text(x + 0.5 * out * _GRID, y - 0.5 * _FIELD - 1.2, letter, ha="center")
        for x, y, way in (
            (across, self.low, (0.0, -1.0)), (across, self.high, (0.0, 1.0)),
            (self.left, along, (-1.0, 0.0)), (self.right, along, (1.0, 0.0)),
        ):  # fmt: skip
            ends = np.array([x, y]) + np.outer([-5.0, _MARGIN - 1.0], way)
            self.line(ends, 0.7)

    def line(self, points: Any, width: float = THIN, style: str = "-", fill: str = "none") -> None:
        """A polyline, or a filled figure that hides what was drawn before; `hatch` cuts it."""
        from matplotlib.patches import Polygon

        p = np.atleast_2d(points)
        self.ink.append(p)
        self._depth += 1e-3
        closed = fill != "none" or bool(np.allclose(p[0], p[-1]))
        dashes = {"--": (0, (8, 4)), "-.": (0, (20, 4, 2, 4))}.get(style, "-")
        # an artist, not a patch: the limits of the axes are known
        self.axes.add_artist(
            Polygon(
                p,
                closed=closed,
                facecolor="white" if fill == HATCH else fill,
                hatch="///" if fill == HATCH else None,
                edgecolor="black",
                lw=width * _POINT,
                ls=dashes,
                zorder=self._depth,
                joinstyle="round",
                fill=fill != "none",
            )
        )

    def broken(self, a: Any, b: Any) -> None:
        """A thin line drawn by hand, where a body is drawn broken off (ISO 128-2, 01.1)."""
        p, q = np.asarray(a, dtype=float), np.asarray(b, dtype=float)
        t = np.linspace(0.0, 1.0, 41)[:, None]
        n = np.array([p[1] - q[1], q[0] - p[0]]) / np.linalg.norm(q - p)
        self.line(p + t * (q - p) + 0.7 * np.sin(4.0 * np.pi * t) * n)

    def circle(
        self, middle: Any, radius: float, width: float = WIDE, style: str = "-", fill: str = "none"
    ) -> None:
        """A circle; filled it hides what was drawn before."""
        t = np.linspace(0.0, 2.0 * np.pi, 97)
        ring = np.asarray(middle) + radius * np.column_stack([np.cos(t), np.sin(t)])
        self.line(ring, width, style, fill)

    def box(self, x: float, y: float, w: float, h: float, width: float = THIN) -> None:
        """A rectangle."""
        self.line([[x, y], [x + w, y], [x + w, y + h], [x, y + h], [x, y]], width)

    def text(
        self, x: float, y: float, words: str, size: float = 2.5, ha: str = "left", turn: float = 0.0
    ) -> None:
        """Words of a height in millimetres, standing on a line."""
        self._depth += 1e-3
        wide, begin = length_of(words, size), {"left": 0.0, "center": 0.5, "right": 1.0}[ha]
        box = np.array([[0.0, 0.0], [wide, 0.0], [wide, size], [0.0, size], [0.0, 0.0]])
        along = np.array([np.cos(np.radians(turn)), np.sin(np.radians(turn))])
        axes = np.array([along, [-along[1], along[0]]])
        self.ink.append(np.array([x, y]) + (box - [begin * wide, 0.0]) @ axes)
        self.axes.text(
            x, y, words, fontsize=1.35 * size * _POINT, ha=ha, va="baseline", rotation=turn,
            rotation_mode="anchor", zorder=self._depth,
        )  # fmt: skip

    def label(self, middle: Any, radius: float, words: str, size: float = LETTER_HEIGHT) -> None:
        """Words beside a circle, on the side where least is drawn."""
        p, half = np.asarray(middle, dtype=float), 0.5 * np.array([length_of(words, size), size])
        reach = radius + 2.0 * half[0] + 2.0 * _CLEAR
        ink = self._dense_ink()
        ink = ink[(np.abs(ink - p) < reach).all(axis=1)]
        ways = np.pi / 4.0 + np.arange(_WAYS) * 2.0 * np.pi / _WAYS
        ways = np.column_stack([np.cos(ways), np.sin(ways)])
        places = p + (radius + _CLEAR) * ways + half * np.clip(1.4 * ways, -1.0, 1.0)
        beyond = np.maximum(np.abs(ink - places[:, None]) - half, 0.0)
        room = np.hypot(beyond[..., 0], beyond[..., 1]).min(axis=1, initial=_CLEAR)
        best = places[np.argmax(np.round(room, 1))]
        self.text(best[0], best[1] - half[1], words, size=size, ha="center")

    def arrow(self, tip: Any, direction: Any) -> None:
        """Head of an arrow."""
        d = np.asarray(direction, dtype=float)
        d /= np.linalg.norm(d)
        n, p = np.array([-d[1], d[0]]), np.asarray(tip, dtype=float)
        head = [p, p - _ARROW * d + 0.4 * n, p - _ARROW * d - 0.4 * n]
        self._depth += 1e-3
        self.axes.fill(*np.array(head).T, color="black", lw=0, zorder=self._depth)

    def dimension(self, a: Any, b: Any, offset: float, words: str) -> None:
        """A linear dimension between two places, its line `offset` to the left of the way."""
        p, q = np.asarray(a, dtype=float), np.asarray(b, dtype=float)
        along = (q - p) / np.linalg.norm(q - p)
        n = np.array([-along[1], along[0]])
        side = np.sign(offset) * n
        c, d = p + offset * n, q + offset * n
        for begin, end in ((p, c), (q, d)):
            self.line([begin + 1.0 * side, end + 1.5 * side])
        self.line([c, d])
        self.arrow(c, -along)
        self.arrow(d, along)
        turn = float(np.degrees(np.arctan2(along[1], along[0])))
        up, turn = (n, turn) if -89.9 < turn <= 90.1 else (-n, turn - 180.0)
        middle = 0.5 * (c + d) + 0.9 * up
        self.text(middle[0], middle[1], words, ha="center", turn=turn)

    def leader(self, tip: Any, elbow: Any, words: str = "") -> None:
        """A line from words to what they are about."""
        p, e = np.asarray(tip, dtype=float), np.asarray(elbow, dtype=float)
        self.line([p, e])
        self.arrow(p, p - e)
        if words:
            right = e[0] >= p[0]
            end = np.add(e, [4.0 if right else -4.0, 0.0])
            self.line([e, end])
            self.text(end[0] + (1.0 if right else -1.0), end[1] - 0.9, words,
                      ha="left" if right else "right")  # fmt: skip

    def datum(self, foot: Any, direction: Any, letter: str) -> None:
        """Filled triangle on a face, and the letter in its box (ISO 5459)."""
        d, p = np.asarray(direction, dtype=float), np.asarray(foot, dtype=float)
        n = np.array([-d[1], d[0]])
        self._depth += 1e-3
        triangle = np.array([p + 1.6 * n, p - 1.6 * n, p + 2.6 * d])
        self.axes.fill(*triangle.T, color="black", lw=0, zorder=self._depth)
        middle = p + 9.0 * d
        self.line([p + 2.6 * d, middle - 2.5 * d])
        self.box(middle[0] - 2.5, middle[1] - 2.5, 5.0, 5.0)
        self.text(middle[0], middle[1] - 1.3, letter, size=3.0, ha="center")

    def target(self, place: Any, middle: Any, name: str) -> None:
        """Datum target point: a cross on the face, and its name in a halved circle (ISO 5459)."""
        p, m = np.asarray(place, dtype=float), np.asarray(middle, dtype=float)
        for way in (np.array([1.5, 1.5]), np.array([1.5, -1.5])):
            self.line([p - way, p + way], WIDE)
        way = (p - m) / np.linalg.norm(p - m)
        self.line([m + 5.0 * way, p])
        self.circle(m, 5.0, THIN, fill="white")
        self.line(m + np.array([[-5.0, 0.0], [5.0, 0.0]]))
        self.text(m[0], m[1] - 3.7, name, ha="center")

    def cut(self, at: Any, way: Any, letter: str) -> None:
        """End of a cutting plane: a thick line, the direction in which is looked, its letter."""
        p, d = np.asarray(at, dtype=float), np.asarray(way, dtype=float)
        n = np.array([d[1], -d[0]])
        self.line([p - 3.0 * n, p + 3.0 * n], 0.7)
        self.line([p - 7.0 * d, p])
        self.arrow(p, d)
        x, y = p - 10.5 * d
        self.text(float(x), float(y) - 1.3, letter, size=3.5, ha="center")

    def edges(self, x: float, y: float, outer: str, inner: str) -> None:
        """General signs of edges of undefined shape (ISO 13715): outer edges, inner edges."""
        for k, words in enumerate((outer, inner)):
            at = x + 28.0 * k
            self.line([[at, y], [at + 3.0, y + 3.0], [at + 3.0, y + 7.0]], 0.3)
            self.line([[at + 3.0, y + 3.0], [at + 7.0, y + 3.0]], 0.3)
            self.text(at + 8.0, y + 3.2, words)

    def roughness(self, foot: Any, words: str) -> None:
        """Sign of ISO 21920-1 for a machined face, standing on it."""
        x, y = np.asarray(foot, dtype=float)
        self.line([[x - 1.4, y + 2.4], [x, y], [x + 2.8, y + 4.8], [x + 15.0, y + 4.8]])
        self.line([[x - 1.4, y + 2.4], [x + 1.4, y + 2.4]])
        self.text(x + 3.4, y + 1.4, words)

    def tolerance(self, x: float, y: float, kind: str, width: str, datums: str) -> float:
        """A tolerance frame of ISO 1101; returns how wide it is."""
        cells = [7.0, 3.0 + 2.1 * len(width), *([6.0] * len(datums))]
        at = x
        for cell in cells:
            self.box(at, y, cell, 6.0)
            at += cell
        self._sign(kind, x + 3.5, y + 3.0)
        self.text(x + 7.0 + 0.5 * cells[1], y + 1.8, width, ha="center")
        for k, letter in enumerate(datums):
            self.text(x + 10.0 + cells[1] + 6.0 * k, y + 1.8, letter, ha="center")
        return sum(cells)

    def attached(
        self, at: Any, kind: str, width: str, datums: str, tip: Any, words: str = ""
    ) -> None:
        """A tolerance frame with its leader to the feature, and words beside or above it."""
        x, y = float(at[0]), float(at[1])
        long = self.tolerance(x, y, kind, width, datums)
        goal = np.asarray(tip, dtype=float)
        above = goal[1] > y
        start = np.array([np.clip(goal[0], x + 2.0, x + long - 2.0), y + 6.0 if above else y])
        self.line([start, goal])
        self.arrow(goal, goal - start)
        if words:
            beside = (x + long + 1.5, y + 1.8) if above else (x, y + 6.8)
            self.text(*beside, words)

    def crowd(self, low: Any, high: Any) -> int:
        """Points of what is drawn within a rectangle, half a millimetre apart."""
        ink = self._dense_ink()
        return int(np.count_nonzero(((ink > low) & (ink < high)).all(axis=1)))

    def _dense_ink(self) -> Array:
        """Points of what is drawn, half a millimetre apart at most, (N, 2)."""
        new = [_dense(line) for line in self.ink[self._lines :]]
        self._lines = len(self.ink)
        self._points = np.concatenate([self._points, *new])
        return self._points

    def contours(self, x: Array, y: Array, z: Array, levels: int) -> None:
        """Thin lines of equal height over a grid."""
        self._depth += 1e-3
        self.axes.contour(x, y, z, levels=levels, colors="0.6", linewidths=0.4, zorder=self._depth)

    def _sign(self, kind: str, x: float, y: float) -> None:
        middle, t = np.array([x, y]), np.linspace(0.0, np.pi, 40)
        signs: dict[str, list[Any]] = {
            "flatness": [[[-2.4, -1.2], [1.2, -1.2], [2.4, 1.2], [-1.2, 1.2], [-2.4, -1.2]]],
            "parallelism": [[[-1.6, -1.8], [0.2, 1.8]], [[-0.2, -1.8], [1.6, 1.8]]],
            "perpendicularity": [[[-2.0, -1.6], [2.0, -1.6]], [[0.0, -1.6], [0.0, 1.8]]],
            "position": [[[-2.4, 0.0], [2.4, 0.0]], [[0.0, -2.4], [0.0, 2.4]]],
            "profile": [np.column_stack([2.2 * np.cos(t), 2.4 * np.sin(t) - 1.2]),
                        [[-2.2, -1.2], [2.2, -1.2]]],
        }  # fmt: skip
        for points in signs[kind]:
            self.line(middle + np.asarray(points), 0.3)
        if kind == "position":
            self.circle(middle, 1.5, 0.3)

    def table(
        self, x: float, top: float, widths: Sequence[float], rows: Sequence[Sequence[str]],
        title: str,
    ) -> float:  # fmt: skip
        """A table under its title, first row bold lines; returns the height of its lower edge."""
        self.text(x, top + 1.2, title, size=3.0)
        height, y = ROW, top
        for number, row in enumerate(rows):
            at = x
            for width, words in zip(widths, row, strict=True):
                self.box(at, y - height, width, height, WIDE if number == 0 else 0.13)
                self.text(at + 1.0, y - height + 1.4, words)
                at += width
            y -= height
        return y


def length_of(words: str, size: float = LETTER_HEIGHT) -> float:
    """How long words are, mm."""
    return size * sum(_WIDE if letter.isupper() else _NARROW for letter in words)


def _dense(line: Array) -> Array:
    """Points on a polyline, half a millimetre apart at most."""
    far = np.linalg.norm(np.diff(line, axis=0), axis=1)
    if not len(far):
        return line
    at = np.concatenate([[0.0], np.cumsum(far)])
    t = np.linspace(0.0, at[-1], int(2.0 * at[-1]) + 2)
    return np.column_stack([np.interp(t, at, line[:, k]) for k in (0, 1)])
