"""Every family of features on a mill of three axes is what it was when it was looked at."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from unchanged import Unchanged, folded, summary

from matstd.artefact.body import write_standard
from matstd.artefact.brief import read_project
from matstd.artefact.compare import comparison
from matstd.artefact.hidden import write_scan_path
from matstd.artefact.place import families, wavy_choice
from matstd.artefact.place.body_choice import body_choice
from matstd.artefact.worth import (
    TouchOptions,
    ball_choice,
    ball_places,
    criterion_for,
    poses_within,
    random_touches,
    visibility,
)

PROJECT = Path(__file__).parents[2] / "examples" / "wavy_face.toml"


@pytest.fixture(scope="module")
def built():
    """Families with few touches and few candidates, and the figures by which one wins."""
    brief = read_project(PROJECT)
    few = replace(brief.options, family="auto", patches=3, balls=4, sites=20)
    brief = replace(brief, options=replace(few, choice=TouchOptions(24, 3, 9)))
    reach, blank, options, rng = brief.reach, brief.blank, brief.options, np.random.default_rng(3)
    made = []
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(ball_choice, "_PLACES", 30)
        patch.setattr(wavy_choice, "_RIMS", (42.0, 60.0))
        patch.setattr(wavy_choice, "_WAVELENGTHS", (60.0,))
        patch.setattr(comparison, "COUNTS", (4,))
        patch.setattr(comparison, "rivals", lambda *_: {})
        figures = families._figures
        patch.setattr(families, "_figures", lambda *of: made.append(of[1]) or figures(*of))
        criterion = criterion_for(
            reach, brief.population.expected("w"), blank, brief.workspace, options.noise, rng,
            options.criterion, options.choice.touches, brief.population,
        )  # fmt: skip
        poses = poses_within(reach.chain, brief.rotary, options.choice.poses)
        places = ball_places(criterion.plain, blank, poses, rng)
        bodies = body_choice(places, poses, options.patches, options.sites, rng)
        free = random_touches(reach, criterion.volume, criterion.rotary, 60, rng)
        choices = criterion, places, poses, blank, options.choice, visibility(criterion, free), rng
        with comparison.compared(*choices, options.balls) as others:
            site = families.Site(
                brief=brief, criterion=criterion, places=places, bodies=bodies,
                rivals=others.of_balls, all_poses=poses, progress=lambda *_: None,
            )  # fmt: skip
            chosen, judged = families.built_family(site)
            rivals = others.all()
    return made, judged, chosen.family, rivals, site


def test_the_figures_are_what_they_were(built, unchanged: Unchanged) -> None:
    _, figures, family, rivals, site = built
    lines = [f"built: {family}, best balls {site.best_balls:.5g}", *map(str, figures)]
    lines += [
        f"{r.name} {r.rms:.5g} {r.p95:.5g} {r.rms_user:.5g} {r.p95_user:.5g} {r.rms_random:.5g} "
        f"{r.estimable:.5g} {r.value:.5g} {r.available}"
        for r in rivals
        if r.body is not None
    ]
    unchanged("\n".join(lines))


@pytest.mark.parametrize("which", range(4), ids=["balls", "faces", "flat", "wavy"])
def test_a_body_and_its_touches_are_what_they_were(
    built, which: int, tmp_path: Path, unchanged: Unchanged
) -> None:
    one, site = built[0][which], built[4]
    write_standard(tmp_path / "standard.toml", one.standard)
    lines = [folded((tmp_path / "standard.toml").read_text(encoding="utf-8"))]
    for touches in (one.requests, one.proof):
        lines.append(" ".join(touches.feature))
        lines += [summary(v) for v in (*touches.point.T, *touches.normal.T)]
    for k, face in enumerate(one.standard.patches if len(one.scan_poses) else ()):
        path = tmp_path / f"scan{k}.csv"
        write_scan_path(
            path, face, site.options.scan, one.scan_poses, site.brief.reach, one.standard
        )
        lines.append(folded(path.read_text(encoding="utf-8")))
    nearness = one.found.nearness
    lines.append(f"{nearness.count} {nearness.value:.5g} {nearness.efficiency:.3g}")
    unchanged("\n".join(lines))
