"""Whole compensated programs and what a service answers, with the machine of the bench."""

import bench
import numpy as np
import pytest
from unchanged import summary
from written import program_text

from matstd.compensation.field import MachineErrors, State
from matstd.compensation.programs import compensated
from matstd.compensation.service import OutputLimits, Service
from matstd.twin.files import read_errors
from matstd.twin.library import parse_sized_effect
from matstd.twin.units import DEG, UM

PROGRAMS = {
    "holes.ngc": """%
O1234 (A PLATE)
N5 G21 G17 G90 G94 G98
N10 T30 M6
G54 G0 X0 Y0 Z30
G43 H30 Z20
G81 X10 Y10 Z-8 R2 F200
X20
G99 Y30 Z-12
G91 G82 X5 Y5 Z-6 R-1 P0.2 L3
G90 G98 G83 X40 Y0 Z-20 R1 Q5
G80
G53 G0 Z-100
G0 X1 Y1 Z30
G28 G91 Z0
G90 M30
%
""",
    "contour.ngc": """(a contour)
G21 G17 G90 G54 G64 P0.01
T3
M6
S8000 M3
G0 Z50
N70 G0 X-20 Y0
G1 Z-5 F500 M8
G41 D3 G1 X0 F1500
X40 Y30
G3 X40 Y60 I0 J15
G2 X20 Y80 R20
G1 X-20
G40 G1 X-40
G42 D3 X-40 Y40
X-10 Y20
G40 X40 Y0
G18 G2 X20 Z-15 I-10 K-5
G19 G3 Y10 Z-10 R8
G17 G90.1 G2 X10 Y20 I15 J15 P2 (turns)
G91.1 G1 B-20 C45 X20
G93 G1 X30 B0 C0 F2.5
G94 G20 G1 X1.0 Y2.0 F50
M428
G21 G1 X10 Y20 Z-5 B-40 C30 F900
M429
M88 G0 Z50 M9
M30
""",
    "arcs.ngc": """G21 G17 G90
T3 M6
G0 X-30 Y0 Z5
G1 Z-1 F500
G41 D3 X0 Y0
G3 X20 Y20 I0 J20
G2 X0 Y40 I0 J20
G40 G1 X0 Y60
M2
""",
    "holes.H": f"""BEGIN PGM A MM
TOOL CALL 3 Z S100 F300 DL+0.5
L X+0 Y+0 Z+30 R0 FMAX M3
{bench.DRILL}L X+20 Y+10 FMAX M99
L X+30 Z+6 R0 FMAX M89
L Y+40 C+30 FMAX
L X-10 FMAX M99
L X-20 Y-20 FMAX
CYCL CALL M8
CYCL CALL POS X+50 Y+50 Z-5 FMAX
CYCL DEF 7.0 DATUM SHIFT
CYCL DEF 7.1 X+5
L X+0 Y+1 F AUTO
L M140 MB MAX
L Z+50 FMAX M91
L X+1 Y+1 Z+20 FMAX
END PGM A MM
""",
    "contour.H": """0 BEGIN PGM PART MM
1 TOOL CALL 3 Z S8000
2 L Z+50 R0 FMAX M3
3 L X-20 Y+0 R0 FMAX
4 L Z-5 F500 M8
5 L X+0 Y+0 RL F1500 M109
6 L X+40
7 RND R8
8 L Y+40
9 CHF 4
10 L X+10
11 CR X-10 Y+40 R+10 DR+
12 L Y+20 RL M111
13 L X-40 R0
14 CC X+10 Y+20
15 LP PR+30 PA+60 F800
16 LP IPA+60 Z-2 M110
17 CP IPA-540 IZ-6 DR-
18 CP PA+90 DR-
19 CC X+100 Y+25
20 L X+100 Y+0
21 C X+100 Y+50 DR+
22 FN 0: Q1 = +3
23 LBL 1
24 L IX-10 IY-Q1
25 CALL LBL 1 REP 2
26 L B-20 C+45 FMAX
27 M126
28 M128 F900
29 L X+10 Y+20 Z-5 F1500
30 L X+60 Y-10 Z+5 B-60 C+120
31 M129
32 M127
33 L Z+50 FMAX M9
34 END PGM PART MM
""",
}
"""With every word that a reader takes."""


@pytest.mark.parametrize("name", PROGRAMS)
def test_a_whole_program(name, frame, known, head, tmp_path, unchanged) -> None:
    found = bench.part_program(
        PROGRAMS[name],
        frame,
        tmp_path,
        name,
        lengths={3: 120.0, 30: 90.0},
        radii={3: 5.0},
        passed=[88],
        tcp_functions=(428, 429),
    )
    done = compensated(found, known, head, 5.0 * UM)
    ends = np.flatnonzero(np.diff(done.motion, append=-1))
    seconds = " ".join(f"{t:.4f}" for t in done.elapsed[ends])
    unchanged(f"{program_text(done.text)}\n{seconds}\n{max(done.leans, default=0.0) / UM:.3f}\n")


def test_answers_of_a_service(bench_chain, errors_file, datum, poses, unchanged) -> None:
    """Readings, directions, a warmer machine, a reading beyond the travel, a silent control."""
    more = ("backlash(X)=8um", "thermal-lag(EZZ)=25um,tau=18min", "thermal-static(EXX,bed)=3um/K")
    effects = [parse_sized_effect(text, bench_chain) for text in more]
    known = [*read_errors(errors_file, bench_chain), *((e.effect, e.theta) for e in effects)]
    state = State(time=60.0, temperature={"bed": 20.0}, spindle_rpm=5000.0)
    errors = MachineErrors.of_errors(bench_chain, known, state)
    limits = OutputLimits(most=60.0 * UM, rate=0.5, patience=0.5, hold=2.0)
    service = Service(errors, bench.LENGTH, datum, limits)
    units = [DEG if bench_chain.link(a).kind == "rotary" else 1.0 for a in bench_chain.axes]
    lines, now = [f"{service.sensors} {service.correction.interpolation / UM:.4f}"], 0.0
    for k, q in enumerate(poses[:12]):
        if k == 6:
            service.drive(1800.0, {"bed": 23.0}, 8000.0)
        beyond = 1000.0 * (k == 9)
        service.move(k, (q / units + beyond).tolist(), now, None if k % 3 else [k - 5] * len(q))
        for step in (0.01, 0.2, 1.0 if k > 7 else 0.2):
            now += step
            answer = service.tick(now)
        sent = answer.sent
        numbers = (*sent.values, sent.lag, *answer.k0, *answer.k1)
        said = f"{answer.sequence} {sent.quality} {answer.refused}"
        lines.append(f"{said} {' '.join(f'{v / UM:.3f}' for v in numbers)} at {summary(answer.p0)}")
    lines.append(
        " ".join(f"{v / UM:.4f}" for v in service.uncertainty((poses[0] / units).tolist()))
    )
    unchanged("\n".join(lines) + "\n")
