"""Logs of a simulated spindle that warms up as in Chen 1995: `python warm_up.py FOLDER`.

Heat flows between bodies: spindle bearings, housing, head, the two sides of the column, bed, room.
Friction goes with the speed to the power of 1.5, and a fast spindle blows its housing cold: neither
is linear. 23 sensors read mixtures of the bodies, none of them a bearing itself. Amplitudes are
those of the paper after 7 h at 1000 rpm: x, y, z 100, 60, 20 µm, tilts 30 and 20 arcsec.
"""

import sys
from pathlib import Path

import numpy as np

BODIES = ("bearing", "housing", "head", "front", "back", "bed")
CAPACITY = np.array([3.0, 20.0, 60.0, 160.0, 160.0, 600.0])  # kJ/K
CONDUCTANCE = {
    (0, 1): 12.0,
    (1, 2): 14.0,
    (2, 3): 16.0,
    (3, 4): 9.0,
    (3, 5): 6.0,
    (4, 5): 6.0,
}  # W/K
TO_ROOM = np.array([0.0, 3.0, 4.0, 6.0, 6.0, 14.0])  # W/K
FRICTION = 200.0  # W at 1000 rpm
AFTER_7_H = {"x_um": 100.0, "y_um": 60.0, "z_um": 20.0, "a_arcsec": 30.0, "b_arcsec": 20.0}
# how much of every drift each body makes, before it is scaled to AFTER_7_H
SHARES = np.array(
    [
        [0.0, 0.2, 0.5, 2.0, -1.2, 0.2],
        [0.1, 0.4, 1.0, 0.6, 0.2, -0.4],
        [0.8, 0.5, 0.3, -0.3, -0.3, 0.0],
        [0.0, 0.1, 0.6, 1.5, -1.5, 0.0],
        [0.2, 0.4, -0.2, 0.8, -0.9, 0.0],
    ]
)
STEP = 60.0


def heated(speed, room, coolant=None):
    """Temperatures of the bodies above 20 degC, (N, 6), one row a minute; coolant in W."""
    T = np.zeros(6) + room[0]
    out = np.empty((len(speed), 6))
    for i, (n, air) in enumerate(zip(speed, room, strict=True)):
        out[i] = T
        for _ in range(2):  # half a minute is short beside the bearings' four
            flow = TO_ROOM * (1.0 + np.array([0, 1, 0, 0, 0, 0]) * n / 1000.0) * (air - T)
            flow[0] += FRICTION * (n / 1000.0) ** 1.5
            flow[4] += 0.0 if coolant is None else coolant[i]
            for (a, b), g in CONDUCTANCE.items():
                flow[a] -= g * (T[a] - T[b])
                flow[b] += g * (T[a] - T[b])
            T = T + flow * 30.0 / (1e3 * CAPACITY)
    return out


def sensor_places():
    """How 23 sensors mix the bodies and the room, (23, 7)."""
    rng = np.random.default_rng(23)
    mix = rng.dirichlet(0.35 * np.ones(6), 23)
    return np.column_stack([0.0 * mix[:, 0], mix])  # no sensor on a bearing


def drifts(bodies):
    """Five drifts of the tool point, (N, 5), µm and arcsec."""
    settled = heated(np.full(421, 1000.0), np.zeros(421))[-1]
    scale = np.array(list(AFTER_7_H.values())) / (SHARES @ settled)
    return bodies @ (scale[:, None] * SHARES).T


def log(path, speed, room, rng, coolant=None, noise=0.05):
    """Write a log of one minute a row."""
    bodies = heated(speed, room, coolant)
    read = np.column_stack([bodies, room]) @ sensor_places().T + 20.0
    read += noise * rng.standard_normal(read.shape)
    moved = drifts(bodies) + 0.2 * rng.standard_normal((len(speed), 5))
    names = ["time_s", "spindle_rpm", *(f"T_s{k + 1}_degC" for k in range(23)), *AFTER_7_H]
    table = np.column_stack([np.arange(len(speed)) * STEP, speed, read, moved])
    np.savetxt(path, table, "%.5g", ",", header=",".join(names), comments="")


def room_of(minutes, rng):
    """Room temperature above 20 degC: day and night, and weather."""
    t = np.arange(minutes) / 1440.0
    days = np.arange(int(t[-1]) + 2)
    weather = np.interp(t, days, rng.normal(0.0, 0.7, len(days)))
    return 1.5 * np.sin(2.0 * np.pi * (t - 0.4)) + weather


def at_random(minutes, rng):
    """Speeds drawn anew, 30 min on and 15 min off."""
    count = minutes // 45 + 1
    on = np.tile(np.r_[np.ones(30), np.zeros(15)], count)
    return (np.repeat(rng.uniform(300.0, 2700.0, count), 45) * on)[:minutes]


def main(folder, seed=1995):
    """Training at five speeds, two tests at speeds that never came, a week with a change."""
    rng = np.random.default_rng(seed)
    folder = Path(folder)
    folder.mkdir(parents=True, exist_ok=True)
    speeds = [np.r_[np.full(360, n), np.zeros(600)] for n in (600, 1000, 1500, 2100, 2600)]
    train = np.concatenate(speeds)
    log(folder / "train.csv", train, room_of(len(train), rng), rng)
    log(folder / "1250rpm.csv", np.full(390, 1250.0), room_of(390, rng), rng)
    log(folder / "random.csv", at_random(720, rng), room_of(720, rng), rng)
    week = np.concatenate([np.r_[at_random(960, rng), np.zeros(480)] for _ in range(7)])
    coolant = 150.0 * (np.arange(len(week)) > 3 * 1440)  # from the fourth day, on the column's back
    log(folder / "week.csv", week, room_of(len(week), rng), rng, coolant)


if __name__ == "__main__":
    main(sys.argv[1] if len(sys.argv) > 1 else "logs")
