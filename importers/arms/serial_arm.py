"""Serial arms under a tracker: joint readings with the places at which reflectors really were.

The tracker says where the reflector is, the readings where a controller that believes in the
nominal arm takes it to be; the run has the difference along x, y and z of the tracker. Where the
tracker stands, and where on the arm the reflector sits unless that is stated, is solved for first,
at any size.
"""

import re
from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from matstd.importers.arms.reflectors import Placement, placed, reflector_places
from matstd.importers.sheets import (
    ANGLES,
    MM,
    Sheet,
    bare,
    loads,
    own_columns,
    seconds,
    temperatures,
    unit_of_column,
)
from matstd.twin.errors import BadFile, DesignError, NotEnoughData
from matstd.twin.frames import Array, pose, rotation
from matstd.twin.machine import Axis, Chain, make_chain, table_to_tool
from matstd.twin.record import (
    Instrument,
    Run,
    Setup,
    Touches,
    computed_deviation,
)

_JOINT = re.compile(
    r"(?:\A|[^a-z])(?:j|joint|axis|achse|gelenk|q|theta|a)[\s_.]*(\d)", re.IGNORECASE
)
_TIME = re.compile(r"time|zeit|clock", re.IGNORECASE)
_DH = {"a": r"\Aa\b", "alpha": r"alpha|α", "d": r"\Ad\b", "theta": r"theta|offset|θ"}

FEWEST = 6
"""Poses for the nine unknown numbers of tracker and reflector, three equations each, with some
over."""


def arm_from_dh(sheet: Sheet, readings: Array, is_modified: bool = False) -> tuple[Chain, Array]:
    """An arm from a table of Denavit and Hartenberg's parameters, a row a joint.

    The machine frame has the directions of the base and its origin at the flange with every joint
    at zero; the table frame is the base. An axis gets the letter of the direction that its line is
    nearest to, and that line as its direction.

    Args:
        sheet: Columns a and d in mm, alpha and theta (its offset at reading zero) in degrees,
            unless their names say other units.
        readings: Of the joints, (N, J), rad; travels are theirs.
        is_modified: Whether a joint turns about z of its own frame (Craig), and not about that of
            the frame before it.

    Returns:
        The arm, and the rotation R (3, 3) that takes flange to tool coordinates.

    Raises:
        BadFile: A column that is not there, or as many rows as there are no joints.

    Reference:
        Denavit and Hartenberg 1955; Craig, Introduction to Robotics (modified parameters).
    """
    a, alpha, d, theta = (_dh_column(sheet, name) for name in _DH)
    if len(a) != readings.shape[1]:
        found = f"{len(a)} rows for {readings.shape[1]} columns of joints"
        raise BadFile(sheet.path, "table", found, "a row a joint")
    T, origins, lines = np.eye(4), [], []
    ex, ez = np.eye(3)[0], np.eye(3)[2]
    for i in range(len(a)):
        across = pose(rotation(alpha[i] * ex), a[i] * ex)
        along = pose(rotation(theta[i] * ez), d[i] * ez)
        T = T @ across if is_modified else T
        origins.append(T[:3, 3])
        lines.append(T[:3, 2])
        T = T @ along if is_modified else T @ along @ across
    flange = T[:3, 3]
    names = _names(lines)
    axes = {
        name: Axis(
            range=_travel(readings[:, i]),
            point=_triple(origins[i] - flange),
            direction=_triple(lines[i]),
        )
        for i, name in enumerate(names)
    }
    chain = make_chain("arm", f"[w f {' '.join(names)} t]", axes, _triple(-flange))
    return chain, T[:3, :3]


def _dh_column(sheet: Sheet, name: str) -> Array:
    """One parameter of every joint, mm or rad."""
    is_angle = name in ("alpha", "theta")
    for i, column in enumerate(sheet.columns):
        if re.search(_DH[name], bare(column), re.IGNORECASE):
            units = ANGLES if is_angle else MM
            unit = unit_of_column(column) or ("deg" if is_angle else "mm")
            values = sheet.numbers(i)
            if not np.isfinite(values).all():
                row = int(np.argmin(np.isfinite(values)))
                raise sheet.bad(row, i, "nothing", "a number for every joint")
            return values * units.get(unit, 1.0)
    raise BadFile(
        sheet.path,
        "header",
        f"columns {', '.join(map(repr, sheet.columns))}",
        f"a column {name} among a, alpha, d, theta",
    )


def _names(lines: Sequence[Array]) -> list[str]:
    """Letters of axes about some lines, numbered where one comes again."""
    out: list[str] = []
    for line in lines:
        letter = "ABC"[int(np.argmax(np.abs(line)))]
        count = sum(name[0] == letter for name in out)
        out.append(f"{letter}{count}" if count else letter)
    return out


def _travel(q: Array) -> tuple[float, float]:
    low, high = float(q.min()), float(q.max())
    return (low, high) if high > low else (low - 1.0, high + 1.0)


def _triple(v: Array) -> tuple[float, float, float]:
    x, y, z = (float(c) for c in np.round(v, 12) + 0.0)
    return x, y, z


def joint_readings(sheet: Sheet, axes: Sequence[str] = ()) -> tuple[Array, tuple[str, ...]]:
    """Columns of joints in the order of their numbers (`j1`, `joint 2`, `theta3`), (N, J), rad.

    Degrees where the name of a column has no unit; mm of a joint that slides.

    Args:
        axes: Names of the axes of the arm; columns named so are taken, if all are there.

    Returns:
        The readings, and the names of their columns.

    Raises:
        BadFile: No such columns, or a number twice or left out.
    """
    found = _named_joints(sheet, axes)
    for i, column in enumerate(() if found else sheet.columns):
        match = _JOINT.search(column)
        if match and found.setdefault(int(match.group(1)), i) != i:
            twice = f"{sheet.columns[found[int(match.group(1))]]!r} and {column!r}"
            raise BadFile(sheet.path, "header", twice, "every joint once")
    numbers = sorted(found)
    if not numbers or numbers != list(range(numbers[0], numbers[0] + len(numbers))):
        listed = ", ".join(map(repr, sheet.columns))
        raise BadFile(sheet.path, "header", f"columns {listed}", "columns j1, j2, j3 ... of joints")
    units = {**ANGLES, **MM}
    columns = [found[k] for k in numbers]
    q = [sheet.numbers(i) * units[unit_of_column(sheet.columns[i]) or "deg"] for i in columns]
    return np.stack(q, axis=1), tuple(sheet.columns[i] for i in columns)


def _named_joints(sheet: Sheet, axes: Sequence[str]) -> dict[int, int]:
    """Columns that have the names of axes, `Z` before `z`; empty unless all are there.

    Raises:
        BadFile: Two columns of one name.
    """
    plain = [bare(c) for c in sheet.columns]
    found = {}
    for k, axis in enumerate(axes):
        same = [i for i, name in enumerate(plain) if name == axis]
        same = same or [i for i, name in enumerate(plain) if name.upper() == axis]
        if len(same) > 1:
            both = " and ".join(repr(sheet.columns[i]) for i in same[:2])
            raise BadFile(sheet.path, "header", both, f"one column of the readings of {axis}")
        if not same:
            return {}
        found[k] = same[0]
    return found


def misfit(
    sheet: Sheet, chain: Chain, q: Array, u: float, reflector: Array | None = None,
    joints: Sequence[str] = (),
) -> float:  # fmt: skip
    """What an arm and readings leave of the measured coordinates, rms, mm; as `tracker_run`."""
    return _placed(sheet, chain, q, u, reflector, joints)[2].rms


def tracker_run(
    sheet: Sheet, chain: Chain, q: Array, u: float, reflector: Array | None = None,
    joints: Sequence[str] = (),
) -> Run:  # fmt: skip
    """Run of an arm under a tracker: three rows a reflector and pose, along x, y, z of the tracker.

    Args:
        sheet: With columns x, y, z of one reflector or several; times, temperatures, loads and
            columns of other units (torques, currents) if it has them.
        chain: The arm.
        q: Readings in the order of its axes, (N, A), mm and rad.
        u: Standard uncertainty of one coordinate, mm.
        reflector: In the tool frame, (3,), mm; None finds it.
        joints: Columns of the readings, which are no places.

    Returns:
        The run; its set-up is the tracker's frame, `touches.target` has the reflector.

    Raises:
        DesignError: Readings of other joints than the arm has, or that no arm is measured with.
        NotEnoughData: Poses too few or too alike to say where reflector and tracker are.
    """
    if q.shape[1] != len(chain.programmed_axes) or len(chain.axes) != len(chain.programmed_axes):
        raise DesignError(
            f"{sheet.path}: {q.shape[1]} columns of joints, expected "
            f"{len(chain.programmed_axes)}: {', '.join(chain.programmed_axes)}"
        )
    place, names, found = _placed(sheet, chain, q, u, reflector, joints)
    _check_placed(sheet, found, reflector is not None)
    clock = next((i for i, c in enumerate(sheet.columns) if _TIME.search(c)), None)
    time = np.zeros(len(q))
    if clock is not None:
        time = seconds(sheet, clock)
    force, own = loads(sheet), own_columns(sheet)
    there = _shots(q, place)
    target = found.reflector
    which, of = (np.repeat(k, 3) for k in np.nonzero(there))
    n = len(which)
    touches = Touches(
        chain=chain,
        q=q[which],
        length=-target[of, 2],
        offset=target[of, :2],
        radius=np.zeros(n),
        point=place[which, of],
        normal=np.tile(np.eye(3), (n // 3, 1)),
        setups=(Setup("tracker", found.T_table_tracker),),
        setup=np.zeros(n, dtype=np.int64),
        time=time[which],
        approach=np.zeros((n, len(chain.axes))),
        temperature={name: values[which] for name, values in temperatures(sheet).items()},
        force=None if force is None else force[which],
        value={name: values[which] for name, values in own.items()},
        feature=np.array(names)[of],
        pose=np.unique(which, return_inverse=True)[1],
        instrument=Instrument.TRACKER,
    )
    lines = np.array(sheet.lines)[which]
    return Run(touches, computed_deviation(touches), np.full(n, u), line=lines)


def _shots(q: Array, place: Array) -> NDArray[np.bool_]:
    """Which reflectors were measured at which poses, (N, K)."""
    moved: NDArray[np.bool_] = np.all(np.isfinite(q), axis=1)
    return np.all(np.isfinite(place), axis=2) & moved[:, None]


def _placed(
    sheet: Sheet,
    chain: Chain,
    q: Array,
    u: float,
    reflector: Array | None,
    joints: Sequence[str],
) -> tuple[Array, tuple[str, ...], Placement]:
    """Measured places (N, K, 3), names of reflectors, and where all of them stand."""
    place, names = reflector_places(sheet, joints)
    if reflector is not None and len(names) > 1:
        raise DesignError(f"{sheet.path}: {len(names)} reflectors, expected one where it is stated")
    shots = _shots(q, place).any(axis=1)
    if shots.sum() < FEWEST:
        raise NotEnoughData(f"{sheet.path}: {int(shots.sum())} poses, expected {FEWEST} at least")
    stated = None if reflector is None else reflector[None]
    return place, names, placed(table_to_tool(chain, q[shots]), place[shots], stated, u)


def _check_placed(sheet: Sheet, found: Placement, is_stated: bool) -> None:
    """Refuse what the poses do not determine, and what no arm is measured with."""
    if found.is_lost:
        raise DesignError(
            f"{sheet.path}: {found.rms:.4g} mm rms are left of measured places that spread by "
            f"{found.spread:.4g} mm: these readings and places are not of one arm; expected joints "
            "and places in the stated order, signs and units"
        )
    if found.free:
        other = "" if is_stated else ", or --reflector X Y Z"
        poses = "off one line" if is_stated else "that turn the tool about lines not parallel"
        raise NotEnoughData(
            f"{sheet.path}: the poses leave open {' and '.join(found.free)}; expected poses "
            f"{poses}{other}"
        )
    if not found.is_settled:
        raise DesignError(
            f"{sheet.path}: the search for the reflector has not converged ({found.rms:.4g} mm rms "
            "are left); expected --reflector X Y Z, or poses farther apart"
        )
