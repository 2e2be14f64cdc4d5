"""What a compensated program leaves, as JSON ("compensated-program/1")."""

from pathlib import Path

import numpy as np

from matstd.compensation.programs.compensation import Compensated
from matstd.twin.files.whole import write_json
from matstd.twin.numbers import in_um, rms, rms_length

FORMAT = "compensated-program/1"


def write_program_result(path: str | Path, done: Compensated) -> None:
    """Write its figures, µm."""
    ends = {"before": done.before[done.is_stated], "after": done.after[done.is_stated]}
    data = {
        "format": FORMAT,
        "program": done.program.path.name,
        "motions": len(done.program.motions),
        "lines": len(done.q),
        "seconds": round(float(done.elapsed[-1]), 3),
        "divided_for_um": in_um(done.tolerance),
        "at_line_ends": {
            key: {
                "rms_um": in_um(rms_length(v)),
                "worst_um": in_um(np.linalg.norm(v, axis=1).max()),
            }
            for key, v in ends.items()
        },
        "between_line_ends": {"worst_um": in_um(done.worst_between) if done.is_cut else None},
        "model_u_um": in_um(rms(done.u)),
        "largest_correction_um": in_um(np.abs(done.added[:, done.program.frame.linear]).max()),
        "lines_left_as_they_are": list(done.unmoved),
    }
    write_json(path, data)
