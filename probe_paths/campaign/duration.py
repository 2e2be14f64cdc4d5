"""Time to probe a body that might be used instead of the standard."""

from dataclasses import replace

import numpy as np

from matstd.artefact.body import Standard
from matstd.artefact.reach import Requests
from matstd.probe_paths.emit import make_programs
from matstd.probe_paths.plan import PlanOptions, Probe, plan_touches
from matstd.twin.errors import NotReachable
from matstd.twin.machine import Chain
from matstd.twin.record import Setup


def probing_time(
    body: Standard,
    chain: Chain,
    probe: Probe,
    setup: Setup,
    requests: Requests,
    options: PlanOptions | None = None,
) -> float:
    """Time on the machine of a plan of the same care, s; nan where no plan can be made.

    Touches that this plan refuses are counted as if they took as long as the others.
    """
    options = replace(options or PlanOptions(), tolerated=len(requests), is_swept=False)
    try:
        plan = plan_touches(body, chain, probe, setup, requests, options)
    except NotReachable:
        return float(np.nan)
    planned = int(np.sum(plan.request >= 0))
    return make_programs(plan).duration * len(requests) / planned
