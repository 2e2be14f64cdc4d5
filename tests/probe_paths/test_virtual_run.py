"""Virtual probing: contacts against a second, slow search; errors against deviations by hand."""

import numpy as np
import pytest
from programs import as_read, ran
from scipy.interpolate import BSpline
from scipy.optimize import brentq, minimize

from matstd.artefact.body import Meeting
from matstd.artefact.reach import Workshop, round_table
from matstd.artefact.tool import Probe
from matstd.probe_paths.campaign import VirtualMachine
from matstd.probe_paths.campaign.stamps import check_program_stamp
from matstd.probe_paths.campaign.virtual_run import Outcome, run_programs
from matstd.probe_paths.emit import make_programs
from matstd.probe_paths.plan import PlanOptions, plan_touches, requests_at
from matstd.twin.effects import ComponentError, LocationError
from matstd.twin.errors import DesignError, NotReachable
from matstd.twin.frames import apply, inverse, pose, rotation, turn
from matstd.twin.machine import Contribution, exact_tip, table_to_tool, tip
from matstd.twin.model import Model, contribution
from matstd.twin.record import Setup, Touches, at_poses
from matstd.twin.units import DEG, NM, UM, URAD

HARDLY_CURVED = 0.002 * UM
"""Some µm along a face of 30 mm radius or more turn its normal by 1e-4."""

CURVED = 0.14 * UM
"""60 µm (all errors at once) along a ball of 10 mm, met by one of 3 mm: 60^2 / (2 * 13 000) µm."""


def deviations(run, standard, chain):
    """By the definition, foot points on the standard at its believed place, one by one."""
    heading = run.program.heading
    T_artefact_table = inverse(heading.setup.T_table_artefact)
    centre = apply(T_artefact_table, tip(chain, run.q, heading.probe.length))
    out = np.empty(len(centre))
    for i, name in enumerate(run.feature):
        surface = standard.features[name]
        uv = surface.project(centre[i : i + 1])
        n, p = surface.normal(uv)[0], surface.point(uv)[0]
        out[i] = n @ (centre[i] - p) - heading.probe.radius
    return out


def test_a_perfect_machine_measures_nothing(read, small, perfect, chain):
    for program in read:
        run = ran(program, small, perfect)
        assert run.outcome is Outcome.DONE
        dev = deviations(run, small, chain)
        assert np.abs(dev).max() < NM


def spline_surface(patch):
    """The patch's surface point by scipy's B-splines, in the artefact frame."""

    def point(uv):
        ku, kv = patch.degree
        rows = BSpline(patch.knots_u, patch.heights, ku)(uv[0])
        height = BSpline(patch.knots_v, rows, kv)(uv[1])
        return apply(patch.T_artefact_patch, np.array([uv[0], uv[1], float(height)]))

    return point


def distance_to(surface, centre, near):
    """Distance of a point from a surface by a search without derivatives."""
    found = minimize(
        lambda uv: np.linalg.norm(surface(uv) - centre),
        near,
        method="Nelder-Mead",
        options={"xatol": 1e-9, "fatol": 1e-13, "maxiter": 2000},
    )
    return found.fun


def test_contacts_against_bisection_of_the_distance(read, small, chain):
    """The true ball runs along the vector; where its distance equals the radius it triggers.

    Neither the surface (scipy's B-splines), nor the distance (a search without derivatives), nor
    the travel (bisection) shares code with the contact search.
    """
    errors = some_errors(chain)
    believed = read[0].heading.setup.T_table_artefact
    stands = pose(rotation(np.array([2e-4, -1e-4, 3e-4])), np.array([0.03, -0.02, 0.04]))
    machine = VirtualMachine(chain, lambda t: contribution(errors, t), setup_error=stands)
    run = ran(read[0], small, machine)
    T_artefact_table = inverse(believed @ stands)
    rows = [i for i, name in enumerate(run.feature) if name.startswith("FF")][::3]
    assert len(rows) >= 3
    for i in rows:
        touch = read[0].touches[i]
        patch = small.features[run.feature[i]]
        surface = spline_surface(patch)

        def gap(t, touch=touch, surface=surface, patch=patch):
            q = (touch.q + t * touch.direction)[None]
            added = contribution(errors, at_poses(chain, q, run.program.heading.probe.length))
            centre = apply(T_artefact_table, exact_tip(chain, q, 160.0, added)[0])
            near = apply(inverse(patch.T_artefact_patch), centre)[:2]
            return distance_to(surface, centre, near) - 3.0

        travel = brentq(gap, 3.0, 7.0, xtol=1e-9)
        found = (run.q[i] - touch.q) @ touch.direction
        assert abs(travel - found) < NM


def some_errors(chain):
    """All parameters of the machine, linear or constant, 10 µm and 20 µrad."""
    rng = np.random.default_rng(11)
    out = []
    for symbol in chain.symbols:
        size = np.array([rng.normal() * (20.0 * URAD if symbol.is_angular else 10.0 * UM)])
        is_component = symbol.family.name == "COMPONENT"
        effect = ComponentError(symbol, "linear") if is_component else LocationError(symbol)
        out.append((effect, size))
    return out


def test_all_errors_at_once_against_the_linear_model(read, small, chain, plan):
    """The model's deviation holds for plane surfaces; a curved one differs in the second order."""
    errors = some_errors(chain)
    machine = VirtualMachine(chain, lambda t: contribution(errors, t))
    model = Model(chain, tuple(effect for effect, _ in errors))
    theta = np.concatenate([size for _, size in errors])
    for program in read:
        run = ran(program, small, machine)
        measured = deviations(run, small, chain)
        rows = [t.number - 1 for t in program.touches]
        n = len(rows)
        touches = Touches(
            chain, run.q, np.full(n, 160.0), np.full(n, 3.0), plan.point[rows], plan.normal[rows],
            (plan.setup,), np.zeros(n, dtype=np.int64), run.time, np.zeros(run.q.shape),
        )  # fmt: skip
        expected = model.deviation(touches, theta)
        assert np.abs(expected).max() > 20.0 * UM
        assert np.abs(measured - expected).max() < CURVED


HAND = [
    # sphere's centre, feature's azimuth and elevation, B, C, error, size, deviation by hand in µm
    # EXX: the tool is 1 µm further in +x, met 1 µm early from +x: the surface seems further out
    ((0.0, 0.0, 100.0), (0.0, 0.0), (0, 0), "EXX", UM, -1.0),
    ((0.0, 0.0, 100.0), (np.pi, 0.0), (0, 0), "EXX", UM, +1.0),
    ((0.0, 0.0, 100.0), (0.0, np.pi / 2), (0, 0), "EZZ", UM, -1.0),
    # the worked examples of the conventions: tool point 100, 50, 140 at readings 100, 50, -200
    ((100.0, 50.0, 127.0), (0.0, np.pi / 2), (0, 0), "EBX", 10 * URAD, +1.0),
    ((87.0, 50.0, 140.0), (0.0, 0.0), (0, 0), "EBX", 10 * URAD, +3.6),
    ((87.0, 50.0, 140.0), (0.0, 0.0), (0, 0), "EC0Y", 10 * URAD, +0.5),
    ((100.0, 37.0, 140.0), (np.pi / 2, 0.0), (0, 0), "EC0X", 10 * URAD, -1.0),
    ((-50.0, 87.0, 140.0), (np.pi / 2, 0.0), (0, 90), "EXC", UM, -1.0),
    ((-50.0, 100.0, 127.0), (0.0, np.pi / 2), (0, 90), "EAC", 10 * URAD, -0.5),
    ((-47.0, 50.0, 180.0), (np.pi, 0.0), (-90, 0), "EX0B", UM, +1.0),
    ((-47.0, 50.0, 180.0), (np.pi, 0.0), (-90, 0), "EBB", 10 * URAD, +1.0),
]


@pytest.mark.parametrize(("centre", "uv", "b_c", "name", "size", "by_hand"), HAND)
def test_one_error_gives_the_deviation_worked_out_by_hand(
    golden, chain, centre, uv, b_c, name, size, by_hand
):
    sphere = golden.DatumSphere("SPH1", np.array(centre), 10.0, 2.0, 2.0, 20.0)
    other = golden.sphere("SPH2", -75.0, -75.0, 40.0)
    of = golden.standard((sphere, other))
    rotary = np.array(b_c[::-1], dtype=float) * DEG
    wanted = requests_at(of, "SPH1", np.array([uv]), rotary)
    slim = Probe(stack=((100.0, 1.0), (160.0, 5.0)), nose_radius=6.0)
    options = PlanOptions(
        standoff=4.0,
        smallest_gap=0.1,
        workshop=Workshop(round_table(20.0)),
        anchor="SPH2",
        tolerated=1,
    )
    setup = Setup("a")
    plan = plan_touches(of, chain, slim, setup, wanted, options)
    read = as_read(make_programs(plan), chain)
    row = int(np.flatnonzero(plan.request == 0)[0])
    symbol = chain.symbol(name)
    is_component = symbol.family.name == "COMPONENT"
    effect = ComponentError(symbol, "constant") if is_component else LocationError(symbol)
    machine = VirtualMachine(chain, lambda t: contribution([(effect, np.array([size]))], t))
    run = ran(read, of, machine)
    dev = deviations(run, of, chain)[row]
    assert abs(dev - by_hand * UM) < 1e-3 * UM


def test_shift_of_the_standard_and_bias_of_the_probe_count_outwards(read, small, chain, plan):
    def disturbance(touches):
        added = Contribution.zeros(len(touches), len(chain.links))
        added.shift[:] = [2.0 * UM, -1.0 * UM, 3.0 * UM]
        added.bias[:] = 0.7 * UM
        return added

    run = ran(read[0], small, VirtualMachine(chain, disturbance))
    rows = [t.number - 1 for t in read[0].touches]
    normal = turn(plan.setup.T_table_artefact, plan.normal[rows])
    expected = normal @ np.array([2.0, -1.0, 3.0]) * UM + 0.7 * UM
    measured = deviations(run, small, chain)
    assert np.abs(measured - expected).max() < HARDLY_CURVED


def test_a_probe_that_differs_from_its_calibration(read, small, chain, plan):
    """A larger ball meets early, so does a longer probe where the surface looks up at it."""
    machine = VirtualMachine(chain, radius_error=5.0 * UM, length_error=4.0 * UM)
    run = ran(read[0], small, machine)
    rows = [t.number - 1 for t in read[0].touches]
    normal = turn(plan.setup.T_table_artefact, plan.normal[rows])
    axis = table_to_tool(chain, run.q)[:, :3, 2]
    expected = 5.0 * UM + 4.0 * UM * np.einsum("ni,ni->n", normal, axis)
    assert np.abs(deviations(run, small, chain) - expected).max() < HARDLY_CURVED


def test_noise_is_that_of_the_trigger_and_of_the_seed(read, small, chain):
    machine = VirtualMachine(chain, noise=2.0 * UM)
    runs = [ran(read[0], small, machine, seed) for seed in (4, 4, 5)]
    dev = [deviations(run, small, chain) for run in runs]
    drawn = np.random.default_rng(4).normal(0.0, 1.0, len(dev[0])) * 2.0 * UM
    assert np.abs(dev[0] - drawn).max() < HARDLY_CURVED
    assert np.array_equal(dev[0], dev[1])
    assert np.abs(dev[0] - dev[2]).max() > UM


def test_a_vector_the_wrong_way_meets_nothing_and_the_program_stops(
    programs, chain, small, perfect, read
):
    first = programs.programs[0].text
    third = first.split("TCH PROBE 4.2 ")[3].split("\r\n")[0]
    turned = third.translate(str.maketrans("+-", "-+"))
    broken = as_read(programs, chain, text=first.replace(third, turned, 1))
    run = ran(broken, small, perfect)
    assert run.outcome is Outcome.NO_CONTACT
    assert run.reached == 3
    with pytest.raises(NotReachable, match=r"touch 3 on .*meets nothing"):
        run.check_done()
    log = run.log["MS_A_1.TXT"].splitlines()
    assert [line.split()[0] for line in log if line.startswith(("P ", "NOC", "END"))] == [
        "P", "P", "NOCONTACT",
    ]  # fmt: skip
    # nothing runs after a stop
    assert len(run_programs([broken, read[1]], small, perfect, np.random.default_rng(0))) == 1


@pytest.mark.parametrize(
    ("stands", "met"),
    [
        ((0.0, 0.0, 6.0), {Meeting.INSIDE}),
        ((0.0, 0.0, -9.0), {Meeting.NOTHING}),
        ((25.0, 0.0, 0.0), {Meeting.EDGE, Meeting.SIDE, Meeting.NOTHING}),
    ],
)
def test_a_standard_that_stands_elsewhere_stops_the_program(read, small, chain, stands, met):
    machine = VirtualMachine(chain, setup_error=pose(t=np.array(stands)))
    run = ran(read[0], small, machine)
    assert run.outcome is Outcome.NO_CONTACT
    assert run.meeting[run.reached - 1] in met
    assert np.isnan(run.q[run.reached - 1]).all()


def test_a_touch_beside_the_trimmed_face_is_no_contact(golden, chain, perfect):
    """The spline runs on beyond the face, the metal does not."""
    of = golden.standard()
    wanted = requests_at(of, "FF1", np.array([[0.0, 0.0]]), np.zeros(2))
    plan = plan_touches(of, chain, Probe(), Setup("a"), wanted)
    made = make_programs(plan)
    row = int(np.flatnonzero(plan.request == 0)[0])
    x, y = (f"{axis}{plan.start[row, chain.axis_index(axis)]:+.4f}" for axis in "XY")
    text = made.programs[0].text
    assert text.count(f"{x} {y}") == 2
    for beside, met in ((15.5, {Meeting.EDGE}), (17.0, {Meeting.EDGE}), (30.0, set(Meeting))):
        moved = text.replace(f"{x} {y}", f"X+{beside:.4f} {y}")
        read = as_read(made, chain, text=moved)
        run = ran(read, of, perfect)
        assert run.outcome is Outcome.NO_CONTACT
        assert run.meeting[run.reached - 1] in met


def test_a_program_for_another_standard_is_refused(read, golden):
    other = golden.standard((golden.sphere("BALL", 0.0, 0.0),))
    with pytest.raises(DesignError, match="FF1 in the program; standard 'SMALL-1' has 1 BALL"):
        check_program_stamp(read[0], other)


def test_time_runs_on_from_program_to_program(read, small, perfect):
    runs = run_programs(read, small, perfect, np.random.default_rng(0))
    times = np.concatenate([run.time for run in runs])
    assert np.all(np.diff(times) > 0.0)
    assert runs[1].time[0] > runs[0].end
    # a touch: approach, search, cycle and retract; it takes two seconds or more
    assert np.median(np.diff(times)) > 2.0


def test_directions_of_approach_are_those_of_the_moves(read, small, chain):
    seen = []

    def disturbance(touches):
        seen.append(touches)
        return Contribution.zeros(len(touches), len(chain.links))

    ran(read[0], small, VirtualMachine(chain, disturbance))
    touches = seen[-1]
    assert np.array_equal(touches.approach[:, :2], np.array([t.side[:2] for t in read[0].touches]))
    columns = [chain.axis_index(a) for a in "XYZ"]
    direction = np.array([t.direction for t in read[0].touches])[:, columns]
    moving = direction != 0.0
    assert np.array_equal(touches.approach[:, columns][moving], np.sign(direction[moving]))
