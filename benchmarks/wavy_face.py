"""Effects that no model has: balls, small faces, a plane and a wavy face, touched or scanned.

    OMP_NUM_THREADS=1 python benchmarks/wavy_face.py [--project wavy_face] [--poses 1]
        [--touches 300] [--size MM] [--slope DEG] [--radius MM] [--turn DEG] [--lines MM]
        [--form-um U]

For every layout the signal (root of the noncentrality) and the power at 5 % risk of effects of 2 µm
rms: fields over all linear axes (40 and 25 mm) and short errors of one axis (40 and 20 mm), along
X, Y and Z; set-up, ordinary geometry and calibration with its form are projected out. Balls come
from the optimiser of the design; those of a plane or a wavy face stand beside it as in a design,
and what they leave unknown in the workspace is compared with the best 13 balls. 49 balls leave no
room for a cutter between their posts: they are placed with only the balls clear of each other. Two
minutes of processor time.
"""

import argparse
import time
from dataclasses import replace
from pathlib import Path

import numpy as np

from matstd.artefact.body import FreeformPatch, Standard, max_slope, min_concave_radius
from matstd.artefact.brief import Brief, read_project
from matstd.artefact.hidden import (
    HiddenPower,
    Measurement,
    Scan,
    hidden_power,
    measured_together,
    possible_places,
    scanned,
    showing_poses,
    showing_touches,
    touched,
)
from matstd.artefact.layout import (
    Wave,
    faces_beside,
    faces_fit,
    freeform_faces,
    most_side_by_side,
    wavy_face,
    with_spheres,
)
from matstd.artefact.place import balls_beside, left_unknown, showing_table_poses
from matstd.artefact.reach import joined, spread_poses
from matstd.artefact.worth import (
    BallPlaces,
    Criterion,
    ball_places,
    chosen_poses,
    chosen_touches_on,
    criterion_for,
    each_at,
    poses_within,
    sphere_grid,
    touches_to_choose_from,
)
from matstd.twin.errors import NotReachable
from matstd.twin.frames import Array
from matstd.twin.numbers import rms
from matstd.twin.units import DEG, UM

EXAMPLES = Path(__file__).parents[1] / "examples"
_ON_BALL = 12  # touches of a ball by which table poses are compared
_TRIED_POSES = 12  # of these
HEAD = "field 40 mm: X Y Z         25 mm: X Y Z         bumps 40 mm: X Y Z     20 mm: X Y Z"


class Bench:
    """One machine, and layouts measured on it with equally many touches."""

    def __init__(
        self, brief: Brief, poses: int, touches: int, form: float, chosen: bool = True
    ) -> None:
        rng, self.chosen = np.random.default_rng(brief.seed), chosen
        self.brief, self.touches, self.rng = brief, touches, rng
        plain = replace(brief.options.criterion, potential=0.0)
        plain = replace(plain, calibration=replace(plain.calibration, form=form))
        self.criterion: Criterion = criterion_for(
            brief.reach,
            brief.population.expected("w"),
            brief.blank,
            brief.workspace,
            brief.noise,
            rng,
            plain,
            touches,
            brief.population,
        )
        possible = poses_within(brief.chain, brief.rotary, max(poses, 8))
        self.possible, self.count = possible, poses
        self.balls: BallPlaces = ball_places(self.criterion, brief.blank, possible, rng)
        self.places = possible_places(
            brief.reach, self.criterion.volume, possible, np.random.default_rng(1)
        )

    def poses(self, body: Standard) -> Array:
        """The table poses at which the one face of a body shows most, or else its balls."""
        if not self.chosen:
            return spread_poses(self.possible, self.count)
        here, nothing = self.criterion.on(body), self.possible[:0]
        balls = [each_at(s, sphere_grid(_ON_BALL), nothing) for s in body.spheres]
        given = touched(joined(balls), self.brief.noise)
        if len(body.patches) == 1:
            return showing_table_poses(here, body, given, self.possible, self.places, self.count)
        some = spread_poses(self.possible, _TRIED_POSES)
        lots = []
        for pose in some:
            lot = joined([each_at(s, sphere_grid(_ON_BALL), pose[None]) for s in body.spheres])
            lots.append(touched(lot[self.brief.reach.is_reachable(lot)], self.brief.noise))
        return some[showing_poses(here, given, lots, self.places, self.count)]

    def some(self, body: Standard, count: int, poses: Array) -> Measurement:
        """The touches on a body that show most, spread over balls and squares of 40 mm.

        Those on faces have room for the probe; the balls are spared this, 49 stand close.
        """
        grid, noise, reach = sphere_grid(60), self.brief.noise, self.brief.reach
        lots = [(s.name, each_at(s, grid, poses)) for s in body.spheres]
        for face in body.patches:
            for part, uv in squares(face):
                lots.append((f"{face.name}.{part}", each_at(face, uv, poses)))
        tried = joined([lot for _, lot in lots])
        area = np.repeat(np.arange(len(lots)), [len(lot) for _, lot in lots])
        on_face = np.isin(tried.feature, [face.name for face in body.patches])
        kept = reach.is_reachable(tried)
        kept[kept & on_face] = reach.has_room(body, tried[kept & on_face])
        tried, area, on_face = tried[kept], area[kept], on_face[kept]
        if not self.chosen:
            order = np.random.default_rng(2).permutation(len(tried))[:count]
            return touched(tried[order], noise)
        first, at = np.unique(tried.point, axis=0, return_index=True, return_inverse=True)[1:]
        form = self.criterion.calibration.form * on_face
        may = replace(touched(tried, noise), u=np.hypot(noise, form))
        rows = showing_touches(
            self.criterion.on(body), touched(tried[:0], noise), may, self.places, count,
            at.reshape(-1), np.unique(area[first], return_inverse=True)[1],
        )  # fmt: skip
        return touched(tried[rows], noise)

    def beside(self, face: FreeformPatch) -> Standard:
        """The best 13 balls that stand beside a face."""
        plain, blank = self.criterion.plain, self.brief.blank
        try:
            ring = ball_places(plain, blank, self.possible, self.rng, [face])
            made = balls_beside([face], 13, ring, self.touches)
        except NotReachable:
            made = None
        if made is None:
            raise SystemExit(f"13 balls do not fit beside a face of {2 * face.half_size[0]:g} mm")
        return made

    def left(self, body: Standard) -> float:
        """What as many touches on the balls of a body leave unknown in the workspace, mm rms."""
        criterion, bare = self.criterion, replace(body, patches=())
        choice = replace(self.brief.options.choice, touches=self.touches)
        poses = chosen_poses(criterion.plain.on(bare), body, body.spheres, self.possible, choice)
        tried = touches_to_choose_from(criterion.reach, body, body.spheres, poses, self.touches)
        chosen, _ = chosen_touches_on(criterion.on(bare), tried, choice)
        return rms(left_unknown(criterion, body, tried[chosen]))

    def show(self, name: str, body: Standard, measured: Measurement) -> HiddenPower:
        """Print the figures of a layout."""
        start = time.process_time()
        found = hidden_power(self.criterion.on(body), measured, self.places)
        columns = [
            f"{signal:4.1f};{min(power, 0.999):.2f}"
            for signal, power in zip(found.signal, found.power, strict=True)
        ]
        seconds = time.process_time() - start
        print(f"{name:42s} {'  '.join(columns)}  {seconds:.0f} s", flush=True)
        return found


def squares(face: FreeformPatch) -> list[tuple[int, Array]]:
    """Places every 6 mm on a face, by squares of about 40 mm."""
    axes = [np.linspace(-1.0, 1.0, int(h // 3.0)) * (h - 3.0) for h in face.half_size]
    uv = np.stack(np.meshgrid(*axes, indexing="ij"), axis=-1).reshape(-1, 2)
    k = [np.maximum(1, np.round(h / 20.0)).astype(int) for h in face.half_size]
    cell = [np.minimum((x / h + 1.0) * 0.5 * n, n - 1).astype(int)
            for x, h, n in zip(uv.T, face.half_size, k, strict=True)]  # fmt: skip
    part = cell[0] * k[1] + cell[1]
    return [(int(p), uv[part == p]) for p in np.unique(part)]


def small_faces(bench: Bench, body: Standard) -> tuple[FreeformPatch, ...]:
    """Six small faces beside the balls of a body, as the design draws them."""
    blank = bench.brief.blank
    faces = freeform_faces(blank, 6, 400, np.random.default_rng(3), body.spheres)
    beside = faces_beside(faces, body.spheres, blank)
    faces = [f for f, good in zip(faces, beside, strict=True) if good]
    chosen = most_side_by_side(faces_fit(faces, (), blank.limits), 6)
    return tuple(replace(faces[k], name=f"FF{i}") for i, k in enumerate(chosen, 1))


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--project", default="wavy_face")
    parser.add_argument("--poses", type=int, default=1)
    parser.add_argument("--touches", type=int, default=300)
    parser.add_argument("--size", type=float, default=236.0, help="side of plane and wavy face, mm")
    parser.add_argument("--slope", type=float, default=50.0, help="of the wavy face, degrees")
    parser.add_argument("--radius", type=float, default=8.0, help="of its cutter, mm")
    parser.add_argument("--lines", type=float, default=4.0, help="between lines of the scan, mm")
    parser.add_argument("--wavelength", type=float, default=60.0, help="of the wavy face, mm")
    parser.add_argument("--turn", type=float, default=45.0, help="of its waves against x, degrees")
    parser.add_argument("--form-um", type=float, default=0.3, help="of the calibrated faces")
    parser.add_argument("--at-random", action="store_true", help="touches anywhere, not chosen")
    args = parser.parse_args()
    brief = read_project(EXAMPLES / f"{args.project}.toml")
    bench = Bench(brief, args.poses, args.touches, args.form_um * UM, not args.at_random)
    print(f"{brief.chain.name}, {bench.count} table poses, {args.touches} touches: signal;power")
    print(f"{'':42s} {HEAD}")
    bodies = {}
    for count in (13, 25, 49):
        places = bench.balls
        if count > 25:
            across = np.array([b.centre[:2] for b in places.balls])
            apart = np.linalg.norm(across[:, None] - across, axis=-1)
            places = replace(places, fits=apart > 2.0 * brief.blank.fittings.sphere_radius)
        balls = places.best(count, args.touches)
        bodies[count] = body = with_spheres(brief.blank, [b.centre for b in balls])
        bench.show(f"{len(balls)} balls", body, bench.some(body, args.touches, bench.poses(body)))
    body, half = bodies[13], args.touches // 2
    faces = small_faces(bench, body)
    pads = tuple(face.mean_plane() for face in faces)
    for name, some in (("small faces", faces), ("flat pads there", pads)):
        both = replace(body, patches=some)
        touches = bench.some(both, args.touches, bench.poses(body))
        bench.show(f"13 balls + {len(some)} {name}", both, touches)
    limits = replace(brief.blank.limits, max_slope=60.0 * DEG, min_concave_radius=args.radius)
    bench.brief = brief = replace(brief, blank=replace(brief.blank, limits=limits))
    side = (0.5 * args.size, 0.5 * args.size)
    wave = Wave((0.0, 0.0), side, args.wavelength, args.slope * DEG, turn=args.turn * DEG)
    face, best = wavy_face("FF1", brief.blank, wave), bench.left(body)
    body = bench.beside(face)
    cost = bench.left(body) / best
    print(
        f"face of {args.size:g} mm, slopes to {max_slope(face) / DEG:.0f} degrees, cutter R "
        f"{min_concave_radius(face):.1f}: 13 balls beside it leave {cost:.2f} of the best 13 balls"
    )
    bare = replace(body, patches=())
    for name, one in (("plane", face.mean_plane()), ("wavy face", face)):
        both = replace(body, patches=(one,))
        poses = bench.poses(both)
        print(f"table poses: {np.round(poses / DEG).tolist()}")
        touches = bench.some(both, args.touches, poses)
        bench.show(f"13 balls + {name}, touched", both, touches)
        on_balls = bench.some(bare, half, poses)
        scan = Scan(between=args.lines)
        lines = scanned(one, scan, poses, brief.reach, both)
        words = f"{scan.points(one)} points, {scan.minutes(one):.0f} min"
        bench.show(
            f"13 balls + {name}, scanned, {words}", both, measured_together([on_balls, lines])
        )


if __name__ == "__main__":
    main()
