"""Collisions planted in programs: are all of them found, and is nothing else refused?

    python benchmarks/planted_collisions.py [--count 150] [--seed 1] [--kind sideways …]

Six kinds: rapid moves sideways, dips beside a body, dips towards the table, clamps beside a touch,
clamps in the way beyond a missed surface or up again, turns of the table. Each is pushed towards
its obstacle until the gap is a wanted one: from 0.1 mm inside the clearance to deep inside for what
must be found, from 1 mm beyond the clearance upwards for what must pass. The gap is measured from
outside: kinematics of this machine by hand, surfaces as meshes of trimesh, the tool as exact
cylinders, places along a move sampled. None of it shares a line with the check.

Then the check's own time for 300 touches. Figures of 2 cores: see the end of the output.
"""

import argparse
import importlib.util
import time
from dataclasses import dataclass, replace
from pathlib import Path
from types import ModuleType

import numpy as np
import trimesh
from scipy.spatial.transform import Rotation

from matstd.artefact.body import Standard
from matstd.artefact.reach import Solid, Workshop, round_table
from matstd.probe_paths.campaign import check_moves
from matstd.probe_paths.control import Move, ProbeStep, ReadProgram, interpret
from matstd.probe_paths.emit import make_programs
from matstd.probe_paths.plan import SMALLEST_GAP, PlanOptions, Probe, plan_touches
from matstd.twin.errors import BadFile
from matstd.twin.frames import Array

GOLDEN = Path(__file__).parents[1] / "tests" / "golden" / "make_programs.py"
PROBE = Probe(stack=((40.0, 1.5), (60.0, 8.0), (160.0, 31.0)), nose_radius=50.0)
PITCH = 1.5  # mm between points of a surface
STEP = 0.5  # mm between places along a move
_FARTHEST = 400.0  # mm that is pushed
_COARSE, _COARSEST = 8.0, 64.0  # mm between the places that sort out which points matter
PIVOT, ORIGIN = np.array([0.0, 0.0, -420.0]), np.array([0.0, 0.0, -500.0])
KINDS = ("sideways", "dip", "table", "clamp at a touch", "beyond a touch", "turn")


# --- the outside: kinematics, surfaces, tool ------------------------------------------------


def rotations(rotary: Array) -> tuple[Rotation, Rotation]:
    """Of C and B of the golden machine, [w C' B' X' f Y Z (C1) t]; rotary = (C, B), rad."""
    return Rotation.from_rotvec([0.0, 0.0, rotary[0]]), Rotation.from_rotvec([0.0, rotary[1], 0.0])


def tip_on_table(xyz: Array, rotary: Array) -> Array:
    """Ball centres in the table frame for readings of X, Y, Z (N, 3) at one pose."""
    C, B = rotations(rotary)
    in_machine = xyz - [0.0, 0.0, PROBE.length]
    return C.apply(B.apply(in_machine - PIVOT) + PIVOT) - ORIGIN


def readings_of(tip: Array, rotary: Array) -> Array:
    """The inverse of `tip_on_table`, (N, 3)."""
    C, B = rotations(rotary)
    return B.inv().apply(C.inv().apply(tip + ORIGIN) - PIVOT) + PIVOT + [0.0, 0.0, PROBE.length]


def points_of(mesh: trimesh.Trimesh, pitch: float = PITCH) -> Array:
    """Points all over a mesh, its corners and edges among them."""
    vertices, _ = trimesh.remesh.subdivide_to_size(mesh.vertices, mesh.faces, pitch, max_iter=20)
    # one of each small cell: slivers have corners in heaps
    _, first = np.unique(np.round(vertices / (0.6 * pitch)), axis=0, return_index=True)
    return np.asarray(vertices[first], dtype=np.float64)


def solid_points(solid: Solid, pitch: float = PITCH) -> Array:
    """Of a box or a cylinder of the workshop, which stands on the table here."""
    tall, middle = solid.high - solid.low, 0.5 * (solid.low + solid.high)
    if solid.is_disc:
        mesh = trimesh.creation.cylinder(solid.half_size[0], tall, sections=180)
    else:
        mesh = trimesh.creation.box((2 * solid.half_size[0], 2 * solid.half_size[1], tall))
    turned = Rotation.from_rotvec([0.0, 0.0, solid.turn]).apply(points_of(mesh, pitch))
    return turned + np.array([solid.x, solid.y, middle])


def standard_points(standard: Standard, T: Array, pitch: float = PITCH) -> dict[str, Array]:
    """Points of every body of the standard by name, table frame."""
    base = base_points(standard, pitch)
    return {"BASE": base @ T[:3, :3].T + T[:3, 3]} | features_points(standard, T, pitch)


def base_points(standard: Standard, pitch: float) -> Array:
    """Points of the base, a box with rounded upright edges, artefact frame."""
    half, r = np.array(standard.base.half_size), standard.base.corner_radius
    tall = standard.base.thickness
    box = points_of(trimesh.creation.box((*(2.0 * half), tall)), pitch)
    over = np.abs(box[:, :2]) - (half - r)
    is_cut = np.all(over > 0.0, axis=1) & (np.linalg.norm(over, axis=1) > r)
    angle = np.linspace(0.0, 2.0 * np.pi, int(2.0 * np.pi * r / pitch) + 1)
    arc = r * np.stack([np.cos(angle), np.sin(angle)], axis=-1)
    arc += np.sign(np.round(arc, 9)) * (half - r)  # a quarter of it round each edge
    z = np.linspace(-0.5 * tall, 0.5 * tall, int(tall / pitch) + 2)
    wall = np.column_stack([np.tile(arc, (len(z), 1)), np.repeat(z, len(arc))])
    return np.concatenate([box[~is_cut], wall]) + np.array([0.0, 0.0, 0.5 * tall])


def features_points(standard: Standard, T: Array, pitch: float = PITCH) -> dict[str, Array]:
    """Points of spheres, stems and faces by name, table frame."""
    bodies = {}
    for s in standard.spheres:
        bodies[s.name] = s.centre + points_of(trimesh.creation.icosphere(3, s.radius), pitch)
        z = np.arange(s.foot, s.centre[2], pitch)
        angle = np.linspace(0.0, 2.0 * np.pi, int(60.0 / pitch))
        r = np.interp(z, [s.foot, s.centre[2]], [s.foot_radius, s.stem_radius])
        ring = np.stack([np.outer(r, np.cos(angle)), np.outer(r, np.sin(angle))], axis=-1)
        height = np.repeat(z[:, None, None], len(angle), axis=1)
        stem = np.concatenate([ring, height], axis=-1).reshape(-1, 3)
        bodies[f"{s.name} stem"] = stem + np.array([*s.centre[:2], 0.0])
    for patch in standard.patches:
        half = patch.half_size
        u, v = (np.linspace(-h, h, int(2 * h / pitch) + 1) for h in half)
        uv = np.stack(np.meshgrid(u, v), axis=-1).reshape(-1, 2)
        lid = patch.point(uv)
        rim = np.any(np.isclose(np.abs(uv), half), axis=1)
        down = patch.T_artefact_patch[:3, 2] * np.arange(0.0, patch.depth, pitch)[:, None, None]
        bodies[patch.name] = np.concatenate([lid, (lid[rim] - down).reshape(-1, 3)])
    return {name: p @ T[:3, :3].T + T[:3, 3] for name, p in bodies.items()}


def tool_gap(points: Array, centre: Array, axis: Array) -> Array:
    """Smallest gaps of points (K, 3) from the tool at places (N, 3), (N, K)."""
    return gaps_beside(points - centre[:, None], axis)


def gaps_beside(way: Array, axis: Array) -> Array:
    """Gaps of the tool from points that are so far from its ball centre, (..., 3)."""
    along = way @ axis
    across = np.sqrt(np.maximum((way**2).sum(axis=-1) - along**2, 0.0))
    gap = np.hypot(across, along) - PROBE.radius
    low = np.sqrt(PROBE.radius**2 - PROBE.stack[0][1] ** 2)
    for high, radius in PROBE.shape.cylinders:
        beyond = np.maximum(np.maximum(low - along, along - high), 0.0)
        out = np.maximum(across - radius, 0.0)
        inside = -np.minimum(radius - across, np.minimum(along - low, high - along))
        gap = np.minimum(
            gap, np.where((beyond == 0.0) & (out == 0.0), inside, np.hypot(out, beyond))
        )
        low = high
    return gap


Way = tuple[Array, Array]  # ball centre at begin and end of a straight way, table frame


def way_gaps(points: Array, ways: list[Way], axis: Array, step: float) -> Array:
    """Smallest gap of every point (K, 3) from the tool along some ways, (K,)."""
    best = np.full(len(points), np.inf)
    for begin, end in ways:
        count = int(np.linalg.norm(end - begin) / step) + 2
        places = begin + np.linspace(0.0, 1.0, count)[:, None] * (end - begin)
        for some in np.array_split(places, min(count * len(points) // 400_000 + 1, count)):
            best = np.minimum(best, tool_gap(points, some, axis).min(axis=0))
    return best


def nearest_gaps(points: Array, ways: list[Way], axis: Array) -> Array:
    """Gaps every `STEP` along some ways, (K,): exact for the nearest point, of others from below.

    A gap changes by no more than the tool moves, so that between two coarse places whose gaps are
    large no nearer one lies.
    """
    looks = []
    for begin, end in ways:
        count = int(np.linalg.norm(end - begin) / _COARSE) + 2
        places = begin + np.linspace(0.0, 1.0, count)[:, None] * (end - begin)
        lots = np.array_split(places, min(count * len(points) // 400_000 + 1, count))
        looks.append((places, np.concatenate([tool_gap(points, some, axis) for some in lots])))
    best = min(float(gap.min(initial=np.inf)) for _, gap in looks)
    out = np.full(len(points), np.inf)
    for places, gap in looks:
        step = float(np.linalg.norm(places[1] - places[0]))
        low = np.minimum(gap[:-1], gap[1:]) - 0.5 * step
        i, k = np.nonzero(low < best)
        shares = np.linspace(0.0, 1.0, int(np.ceil(step / STEP)) + 1)
        for some in np.array_split(np.arange(len(i)), len(i) // 20_000 + 1):
            begin, end = places[i[some]], places[i[some] + 1]
            centre = begin[:, None] + shares[:, None] * (end - begin)[:, None]
            fine = gaps_beside(points[k[some]][:, None] - centre, axis).min(axis=1, initial=np.inf)
            low[i[some], k[some]] = fine
        out = np.minimum(out, low.min(axis=0))
    return out


def lower_bounds(points: Array, ways: list[Way], axis: Array) -> Array:
    """What no point can be nearer than, (K,): few places for all, more for those that are near.

    Between two places the gap of a point changes by no more than the way to the nearer one.
    """
    lower = way_gaps(points, ways, axis, _COARSEST) - 0.5 * _COARSEST
    near = np.flatnonzero(lower < lower.min() + _COARSEST)
    lower[near] = way_gaps(points[near], ways, axis, _COARSE) - 0.5 * _COARSE
    return lower


def smallest_gap(points: Array, ways: list[Way], axis: Array) -> float:
    """Of all points: coarse places say which of them need the fine ones."""
    lower = lower_bounds(points, ways, axis)
    few = np.argsort(lower)[:500]
    gap = nearest_gaps(points[few], ways, axis).min()
    left = points[lower < gap]
    return float(min(gap, nearest_gaps(left, ways, axis).min() if len(left) else np.inf))


def pushed(points: Array, ways: list[Way], axis: Array, push: Array, wanted: float) -> float | None:
    """How far the tool has to be pushed for a wanted gap: it shrinks no faster than one pushes.

    Of every point it is known how near it can have come since it was looked at last.
    """
    lower, way = lower_bounds(points, ways, axis), 0.0
    for _ in range(200):
        there = [(begin + way * push, end + way * push) for begin, end in ways]
        few = np.argsort(lower)[:300]
        while True:
            lower[few] = nearest_gaps(points[few], there, axis)
            gap = float(lower[few].min())
            few = np.setdiff1d(np.flatnonzero(lower < gap), few)
            if not len(few):
                break
        gap = float(lower.min())
        if abs(gap - wanted) < 0.02:
            return way
        step = gap - wanted
        way += step
        lower -= abs(step)
        if not -1.0 <= way <= _FARTHEST:
            return None
    return None


# --- what is planted ------------------------------------------------------------------------


@dataclass(frozen=True, eq=False)
class Scene:
    """The golden standard on its table between two clamps.

    `bodies` are points of all but the lower side of the table, `hull` corners of all that turns:
    beyond 90 degrees the lower side of the table is above its face.
    """

    golden: ModuleType
    programs: tuple[ReadProgram, ...]
    standard: Standard
    bodies: dict[str, Array]
    workshop: Workshop
    hull: Array

    @property
    def everything(self) -> Array:
        return np.concatenate(list(self.bodies.values()))


def scene() -> Scene:
    """Programs with a clamp and a post stated, and the points of all that stands there."""
    spec = importlib.util.spec_from_file_location("make_programs", GOLDEN)
    assert spec is not None
    assert spec.loader is not None
    golden = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(golden)
    clamps = (
        Solid(name="CLAMP", half_size=(20.0, 12.0), high=42.0, x=118.0, y=20.0, turn=0.3),
        Solid(name="POST", half_size=(11.0, 11.0), is_disc=True, high=60.0, x=-30.0, y=-122.0),
    )
    workshop = Workshop(round_table(), clamps)
    standard, wanted = golden.standard(), golden.requests(golden.standard(), each=12)
    options = PlanOptions(tolerated=len(wanted), workshop=workshop)
    plan = plan_touches(standard, golden.machine(), PROBE, golden.setup(), wanted, options)
    made = make_programs(plan)
    read = tuple(
        interpret(p.text.encode("ascii"), Path(f"{p.name}.H"), made.masks.get, golden.machine())
        for p in made.programs
    )
    bodies = standard_points(standard, read[0].heading.setup.T_table_artefact)
    bodies |= {solid.name: solid_points(solid) for solid in workshop.solids}
    hull = trimesh.convex.convex_hull(np.concatenate(list(bodies.values()))).vertices
    lowest = workshop.table.low + 0.5  # nothing comes from below
    bodies = {name: p[p[:, 2] > lowest] for name, p in bodies.items()}
    return Scene(golden, read, standard, bodies, workshop, hull)


def is_refused(scene: Scene, steps: list[Move | ProbeStep], workshop: Workshop) -> bool:
    """Whether the check refuses a program of these steps."""
    first = scene.programs[0]
    program = replace(first, steps=tuple(steps), heading=replace(first.heading, workshop=workshop))
    try:
        check_moves(program, scene.standard, scene.golden.machine())
    except BadFile:
        return True
    return False


def full(xyz: Array, rotary: Array) -> Array:
    """Readings in chain order C B X Y Z C1."""
    return np.array([*rotary, *xyz, 0.0])


def a_move(scene: Scene, kind: str, wanted: float, rng: np.random.Generator):
    """A sideways move or a dip, pushed from the side or from above towards what stands there."""
    rotary = np.array([rng.uniform(-3.0, 3.0), rng.choice([0.0, 0.0, -0.4, 0.3])])
    C, B = rotations(rotary)
    up = C.apply(B.apply([0.0, 0.0, 1.0]))
    names = {"table": ["the table"]}.get(kind, [n for n in scene.bodies if n != "the table"])
    body = scene.bodies[str(rng.choice(names))]
    target = body[rng.integers(len(body))]
    side = np.cross(up, rng.normal(size=3))
    side /= np.linalg.norm(side)
    across = np.cross(up, side)
    if kind == "sideways":
        begin, end, push = -70.0 * across, 70.0 * across, -up
        begin, end = begin + target + 300.0 * up, end + target + 300.0 * up
    elif kind == "table":
        begin, end, push = target + 480.0 * up, target + 300.0 * up, -up
    else:
        foot = target - rng.uniform(-5.0, 15.0) * up + 250.0 * side
        begin, end, push = foot + 60.0 * up, foot, -side
    way = pushed(scene.everything, [(begin, end)], up, push, wanted)
    if way is None:
        return None
    ends = readings_of(np.array([begin, end]) + way * push, rotary)
    if np.any(np.abs(ends[:, :2]) > 400.0):
        return None
    steps = [Move(1, full(ends[0], rotary), None), Move(2, full(ends[1], rotary), None)]
    return steps, scene.workshop


def a_clamp(scene: Scene, kind: str, wanted: float, rng: np.random.Generator):
    """A real touch and a further clamp that is pushed towards its moves."""
    touch = scene.programs[0].touches[rng.integers(len(scene.programs[0].touches))]
    rotary, xyz = touch.q[:2], touch.q[2:5]
    direction = touch.direction[2:5]
    name = scene.programs[0].features[touch.feature]
    others = [p for n, p in scene.bodies.items() if n not in (name, f"{name} stem")]
    high = np.array([*xyz[:2], 0.0])
    touch = replace(touch, distance=touch.back + rng.uniform(3.0, 9.0))
    place = [xyz, xyz + touch.back * direction, xyz + touch.distance * direction]
    over = np.array([*place[2][:2], 0.0])
    above, start, contact, end, up = tip_on_table(np.array([high, *place, over]), rotary)
    around = rng.uniform(0.0, 2.0 * np.pi)
    push = -np.array([np.cos(around), np.sin(around), 0.0])
    tall = max(start[2] + rng.uniform(-6.0, 12.0), 5.0)
    clamp = Solid(
        name="PLANT",
        half_size=(rng.uniform(3.0, 15.0),) * 2,
        is_disc=bool(rng.integers(2)),
        high=float(tall),
        turn=float(rng.uniform(0.0, 1.5)),
    )
    shape = solid_points(clamp)

    C, B = rotations(rotary)
    axis = C.apply(B.apply([0.0, 0.0, 1.0]))
    beyond, before = [(start, end), (end, up)], [(above, start), (start, contact)]
    away = np.array([*start[:2], 0.0]) - _FARTHEST * push
    way = pushed(shape + away, beyond if kind == "beyond a touch" else before, axis, -push, wanted)
    if way is None:
        return None
    x, y = (away + way * push)[:2]
    clamp = replace(clamp, x=float(x), y=float(y))
    if wanted > SMALLEST_GAP:  # nothing else of this touch may be too near
        every = [*before, *beyond]
        if smallest_gap(solid_points(clamp), every, axis) < SMALLEST_GAP + 1.0 - 0.03:
            return None
        if smallest_gap(np.concatenate(others), every, axis) < SMALLEST_GAP + 0.2:
            return None
    steps = [Move(1, full(high, rotary), None), Move(2, full(xyz, rotary), None), touch]
    return steps, replace(scene.workshop, bodies=(*scene.workshop.bodies, clamp))


def a_turn(scene: Scene, kind: str, wanted: float, rng: np.random.Generator):
    """A turn of both axes at the height that leaves the wanted gap in any order of turning."""
    low, high = np.radians([[-170.0, 170.0], [-100.0, 25.0]]).T
    start = rng.uniform(low, high)
    end = start + rng.choice([-1.0, 1.0], 2) * np.radians(rng.uniform(2.0, [80.0, 60.0]))
    end = np.clip(end, low, high)
    hull = scene.hull + ORIGIN
    top = -np.inf
    for c in np.linspace(start[0], end[0], 41):
        turned = Rotation.from_rotvec([0.0, 0.0, c]).inv().apply(hull)
        for b in np.linspace(start[1], end[1], 121):
            # height after the turn by -b about y through the pivot
            z = PIVOT[2] + (turned[:, 2] - PIVOT[2]) * np.cos(b) + turned[:, 0] * np.sin(b)
            top = max(top, float(z.max()))
    xyz = np.array([0.0, 0.0, top + wanted + PROBE.radius + PROBE.length])
    return [Move(1, full(xyz, start), None), Move(2, full(xyz, end), None)], scene.workshop


MAKERS = {
    "sideways": a_move, "dip": a_move, "table": a_move,
    "clamp at a touch": a_clamp, "beyond a touch": a_clamp, "turn": a_turn,
}  # fmt: skip


def planted(scene: Scene, kind: str, wanted: float, rng: np.random.Generator):
    """One of a kind; what cannot be pushed to its gap is drawn again."""
    while True:
        made = MAKERS[kind](scene, kind, wanted, rng)
        if made is not None:
            return made


def seconds_for(scene: Scene, touches: int) -> float:
    """Time of the check for so many touches, from that for the programs."""
    before = time.process_time()
    done = 0
    for program in scene.programs:
        check_moves(program, scene.standard, scene.golden.machine())
        done += len(program.touches)
    return (time.process_time() - before) * touches / done


def main() -> int:
    """Plant, check, count."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--count", type=int, default=150, help="of each sort (150)")
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--kind", nargs="+", choices=KINDS, default=KINDS, help="of these (all)")
    args = parser.parse_args()
    here = scene()
    wrong = {"missed": 0, "false alarms": 0}
    for kind in args.kind:
        # each kind has numbers of its own, so that a part of a run is a part of the whole
        rng = np.random.default_rng([args.seed, KINDS.index(kind)])
        missed = alarms = 0
        count = -(-args.count // len(KINDS))
        for i in range(count):
            inside = 0.1 if i % 2 == 0 else float(rng.uniform(0.1, 8.0))
            steps, workshop = planted(here, kind, SMALLEST_GAP - inside, rng)
            missed += not is_refused(here, steps, workshop)
            beyond = 1.0 if i % 2 == 0 else float(rng.uniform(1.0, 4.0))
            steps, workshop = planted(here, kind, SMALLEST_GAP + beyond, rng)
            alarms += is_refused(here, steps, workshop)
        print(f"{kind:18s} {count} planted, {missed} missed; {count} free, {alarms} refused")
        wrong["missed"] += missed
        wrong["false alarms"] += alarms
    print(wrong, f"{seconds_for(here, 300):.1f} s for 300 touches")
    return int(any(wrong.values()))


if __name__ == "__main__":
    raise SystemExit(main())
