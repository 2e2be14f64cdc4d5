"""The twin against pinocchio, a kinematics library that shares no code and no conventions with it.

The machine is rebuilt as one serial arm from the table to the tool. Walking from the workpiece to
the foundation turns every primed axis round: its joint moves by plus the reading, and the inverse
of the inverse component error is the component error itself. Every component error is a free-flyer
joint, every displaced line a free-flyer before the axis and its inverse behind it.
"""

import numpy as np
import pinocchio as pin
import pytest
from made_up import ARM, arm_poses

from matstd.twin.effects.joint_sag import KIND
from matstd.twin.machine import (
    Axis,
    Chain,
    Contribution,
    Link,
    exact_tip,
    make_chain,
    reach,
    table_to_tool,
)
from matstd.twin.model import contribution
from matstd.twin.units import DEG, NM

LENGTH = 160.0
TRAVEL = {name: Axis(range=(-400.0, 400.0)) for name in "XYZ"}
TURN = (-180.0 * DEG, 180.0 * DEG)
MACHINES = {
    "table-table": make_chain(
        "table-table",
        "[w C' B' X' f Y Z (C1) t]",
        TRAVEL | {"B": Axis(TURN, (0.0, 0.0, -420.0)), "C": Axis(TURN, (3.0, -2.0, 1.0))},
        (10.0, 20.0, -500.0),
    ),
    "A/C head": make_chain(
        "A/C head",
        "[w Y' f X Z C A t]",
        TRAVEL | {"C": Axis(TURN, (12.0, -3.0, 0.0)), "A": Axis(TURN, (12.0, -3.0, -80.0))},
        (100.0, 20.0, -700.0),
    ),
    "nutating head and table": make_chain(
        "nutating head and table",
        "[w C' X' f Y Z B t]",
        TRAVEL
        | {
            "C": Axis(TURN, (30.0, 40.0, -600.0)),
            "B": Axis(TURN, (0.0, 5.0, 150.0), direction=(0.0, 1.0, -1.0)),
        },
        (30.0, 40.0, -600.0),
    ),
}
CASES = pytest.mark.parametrize("chain", MACHINES.values(), ids=list(MACHINES))


def lean_of(link: Link) -> np.ndarray:
    """Directions of the errors of an axis: its own, the others by the shortest arc."""
    if link.kind == "fixed":
        return np.eye(3)
    letter = np.eye(3)["XYZABC".index(link.name[0]) % 3]
    sense = np.sign(link.direction @ letter)
    arc = pin.Quaternion.FromTwoVectors(letter, sense * link.direction).toRotationMatrix()
    return arc @ np.diag(np.where(letter == 1.0, sense, 1.0))


class Arm:
    """The serial arm: joints in order, with where each takes its configuration from."""

    def __init__(self, chain: Chain) -> None:
        self.chain = chain
        self.model = pin.Model()
        self.parent, self.frame = 0, pin.SE3.Identity()
        self.frame.translation = -chain.table_origin  # machine frame seen from the table's
        self.sources: list[tuple[str, Link]] = []
        for link in chain.links:
            self.add_link(link)
        self.data = self.model.createData()

    def joint(self, kind: object, at: np.ndarray, what: str, link: Link) -> None:
        """A joint at a point of the machine frame (every axis at zero), directions kept."""
        there = self.frame * pin.SE3(np.eye(3), at)
        self.parent = self.model.addJoint(self.parent, kind, there, f"{link.name} {what}")
        self.frame = pin.SE3(np.eye(3), -at)  # back to machine coordinates behind the joint
        self.sources.append((what, link))

    def add_link(self, link: Link) -> None:
        flyer = pin.JointModelFreeFlyer
        if link.kind == "fixed":
            order = ["place", "twist"] if link.name == "w" else ["twist", "place"]
            for what in order:
                self.joint(flyer(), link.point, what, link)
            return
        linear = link.kind == "linear"
        axis = pin.JointModelPrismaticUnaligned if linear else pin.JointModelRevoluteUnaligned
        moved = [(flyer(), "line"), (axis(link.direction), "axis"), (flyer(), "line back")]
        error = [(flyer(), "twist")]
        if linear:  # the error of a linear axis turns about a point that the axis carries along
            out, back = axis(link.direction), axis(link.direction)
            error = [(out, "to lever"), *error, (back, "from lever")]
        # the error is seen from the carrying body: the nearer one to the table on the tool side
        for kind, what in moved + error if link.carries_workpiece else error + moved:
            self.joint(kind, link.point, what, link)

    def configuration(self, q: np.ndarray, added: Contribution, row: int) -> np.ndarray:
        """Configuration of one pose with its errors."""
        values = []
        for what, link in self.sources:
            i = self.chain.link_index(link.name)
            reading = 0.0 if link.kind == "fixed" else q[row, self.chain.axis_index(link.name)]
            if what.endswith("lever"):
                carried = -reading if link.carries_workpiece else reading
                values.append([carried if what == "to lever" else -carried])
                continue
            if what == "axis":
                zero = added.place[row, i, 3:] if link.kind == "rotary" else added.place[row, i, :3]
                values.append([reading + zero["XYZABC".index(link.name[0]) % 3]])
                continue
            vector = (added.twist if what == "twist" else added.place)[row, i].copy()
            if what.startswith("line"):
                if link.kind == "rotary":  # the zero position is in the reading already
                    vector[3 + "ABC".index(link.name[0])] = 0.0
                else:
                    vector[:3] = 0.0
            lean = lean_of(link)
            pose = pin.SE3(pin.exp3(lean @ vector[3:]), lean @ vector[:3])
            # a displaced workpiece-side body comes up from behind: (D M D^-1)^-1 = D M^-1 D^-1
            if what == "line back" or (what == "place" and link.name == "w"):
                pose = pose.inverse()
            values.append(pin.SE3ToXYZQUAT(pose))
        return np.concatenate(values)

    def table_to_tool(self, configuration: np.ndarray) -> np.ndarray:
        pin.forwardKinematics(self.model, self.data, configuration)
        return (self.data.oMi[self.parent] * self.frame).homogeneous

    def columns(self, configuration: np.ndarray) -> np.ndarray:
        """Velocity of the tip per unit of every link's component error, (L, 6, 3)."""
        tip = self.frame * pin.SE3(np.eye(3), np.array([0.0, 0.0, -LENGTH]))
        J = pin.computeFrameJacobian(
            self.model, self.data, configuration, self.tip_frame(tip), pin.LOCAL_WORLD_ALIGNED
        )
        out = np.zeros((len(self.chain.links), 6, 3))
        for k, (what, link) in enumerate(self.sources):
            if what == "twist":
                start = self.model.joints[k + 1].idx_v
                moved = J[:3, start : start + 6].T.reshape(2, 3, 3)
                out[self.chain.link_index(link.name)] = (lean_of(link).T @ moved).reshape(6, 3)
        return out

    def tip_frame(self, tip: pin.SE3) -> int:
        if not self.model.existFrame("tip"):
            self.model.addFrame(pin.Frame("tip", self.parent, tip, pin.FrameType.OP_FRAME))
            self.data = self.model.createData()
        return self.model.getFrameId("tip")


def readings(chain: Chain, n: int) -> np.ndarray:
    rng = np.random.default_rng(21)
    return np.stack([rng.uniform(*chain.link(a).range, size=n) for a in chain.axes], axis=-1)


@CASES
def test_nominal_poses(chain):
    q = readings(chain, 25)
    arm, nothing = Arm(chain), Contribution.zeros(25, len(chain.links))
    ours = table_to_tool(chain, q)
    for row in range(25):
        theirs = arm.table_to_tool(arm.configuration(q, nothing, row))
        np.testing.assert_allclose(ours[row], theirs, rtol=0, atol=NM)


def exact_pose(chain: Chain, q: np.ndarray, added: Contribution) -> np.ndarray:
    """Pose of the tool in the table frame, (N, 4, 4), from where it carries four points."""
    out = np.tile(np.eye(4), (len(q), 1, 1))
    still = np.zeros((len(q), 3))
    out[:, :3, 3] = exact_tip(chain, q, still, added)
    for k in range(3):
        out[:, :3, k] = exact_tip(chain, q, still + np.eye(3)[k], added) - out[:, :3, 3]
    return out


@CASES
def test_exact_poses_with_every_error_in_them(chain):
    rng = np.random.default_rng(22)
    q = readings(chain, 25)
    size = np.array([0.1, 0.1, 0.1, 2e-4, 2e-4, 2e-4])
    added = Contribution.zeros(25, len(chain.links))
    added.twist[:] = rng.uniform(-1.0, 1.0, added.twist.shape) * size
    added.place[:] = rng.uniform(-1.0, 1.0, added.place.shape) * size
    for i, link in enumerate(chain.links):
        if link.kind == "linear":  # no more of a linear axis's line than its zero and squareness
            across = added.place[:, i, 3:] @ link.direction
            added.place[:, i, 3:] -= across[:, None] * link.direction
    arm = Arm(chain)
    ours = exact_pose(chain, q, added)
    far = np.abs(ours - table_to_tool(chain, q))[:, :3, 3].max()
    assert far > 0.1  # mm: the errors are really in
    for row in range(25):
        theirs = arm.table_to_tool(arm.configuration(q, added, row))
        np.testing.assert_allclose(ours[row], theirs, rtol=0, atol=NM)


@CASES
def test_columns_of_component_errors(chain):
    q = readings(chain, 25)
    arm, nothing = Arm(chain), Contribution.zeros(25, len(chain.links))
    ours = reach(chain, q, LENGTH).twist
    tip = arm.frame * pin.SE3(np.eye(3), np.array([0.0, 0.0, -LENGTH]))
    arm.tip_frame(tip)
    for row in range(25):
        theirs = arm.columns(arm.configuration(q, nothing, row))
        for i, link in enumerate(chain.links):
            np.testing.assert_allclose(ours[row, i], theirs[i], rtol=0, atol=NM, err_msg=link.name)


def test_weights_turn_the_joints_of_an_arm_as_gravity_does():
    """Generalised gravity of an arm with masses at its joints and flange is what holds it up.

    A joint gives way by the compliance times the negative of that, about its own line: the twist
    is that of the joint's own letter.
    """
    touches = arm_poses()
    model, masses = pin.Model(), {}
    before, parent = np.zeros(3), 0
    rng = np.random.default_rng(2)
    for name in ARM.axes:
        link = ARM.link(name)
        place = pin.SE3(np.eye(3), link.point - before)
        joint = pin.JointModelRevoluteUnaligned(link.direction)
        parent = model.addJoint(parent, joint, place, name)
        before = link.point
        # joints that stand on one another share their mass
        masses[name] = 0.0 if name == "A1" else float(rng.uniform(5.0, 40.0))
        at_own_point = pin.Inertia(masses[name], np.zeros(3), np.zeros((3, 3)))
        model.appendBodyToJoint(parent, at_own_point, pin.SE3.Identity())
    masses["flange"] = 12.0
    payload = pin.Inertia(masses["flange"], np.zeros(3), np.zeros((3, 3)))
    model.appendBodyToJoint(parent, payload, pin.SE3(np.eye(3), -before))
    model.gravity.linear = np.array([0.0, 0.0, -1.0])  # weights in N, levers in mm
    data = model.createData()
    holding = np.array([pin.computeGeneralizedGravity(model, data, q) for q in touches.q])
    scale = np.abs(holding).max()
    for i, name in enumerate(ARM.axes):
        if np.abs(holding[:, i]).max() < 1e-9 * scale:
            continue  # an upright line carries no torque
        effect = KIND.make(ARM, [name])
        theta = np.array([masses[p] for p in effect.places])
        twist = contribution([(effect, theta)], touches).twist[:, ARM.link_index(name), 3:]
        own = np.eye(3)["ABC".index(name[0])]
        expected = -holding[:, i, None] * own
        np.testing.assert_allclose(twist, expected, atol=1e-9 * scale)
