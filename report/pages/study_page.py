"""Sensitivities on a page: maps, maps in three dimensions, dominant errors of every region."""

from collections import Counter
from collections.abc import Sequence
from pathlib import Path

import numpy as np

from matstd.report.layout import KeyFigure, Page, Picture, Section, Table, write_page
from matstd.report.maps import shows_more
from matstd.report.numbers import digits, um
from matstd.report.scenes import Scene, draw_volumes
from matstd.report.verdict import study_meaning
from matstd.report.words import dominant_words, place_words, sampling_words, unsampled
from matstd.sensitivity.shares import regions
from matstd.sensitivity.study import Study, Volume, has_volume, level, volume
from matstd.twin.errors import DesignError
from matstd.twin.frames import Array
from matstd.twin.machine import Chain, Family, Symbol
from matstd.twin.units import DEG, UM, URAD

ERROR_3D, S_3D = "volumetric_3d.png", "sensitivity_3d.png"

_ORDER = (
    "sensitivity.png",
    S_3D,
    "sensitivity_maps.png",
    ERROR_3D,
    "volumetric_sections.png",
    "volumetric_rotary.png",
    "volumetric_axes.png",
    "variance_regions.png",
    "variance_shares.png",
)
_S_SCENES = 3

Shown = tuple[str, str]  # file and caption of a picture

_VARIANCE = "Errors that make half of the variance, region by region (exact to first order)"


def write_study_page(
    study: Study, folder: Path, pictures: Sequence[Shown], project: str = ""
) -> list[str]:
    """Write report.html of a study by itself, with its maps in three dimensions.

    Args:
        pictures: File and caption of those that exist already, in any order.
        project: Source of the study, for the foot of the page.

    Returns:
        What could not be drawn and why, one line each; the page states it too.
    """
    remarks: list[str] = []
    shown = [*pictures, *draw_study_volumes(study, folder, remarks)]
    chain, v = study.chain, study.volumetric
    page = Page(
        heading=f"Sensitivities of {chain.name}",
        lead=f"Chain `{chain.notation}`, {parameters_words(chain)}.",
        means=study_meaning(study),
        next="`matstd design` places a standard that distinguishes these errors.",
        key=[
            KeyFigure(um(float(v.mean.mean())), "mean volumetric error over the workspace"),
            KeyFigure(um(float(v.p95.mean())), "95 % quantile over machines, mean over the poses"),
            KeyFigure(um(float(v.p95.max())), "95 % quantile over machines at the worst pose"),
        ],
        sections=[Section(warnings=[*chain.remarks, *remarks]), *study_sections(study, shown)],
        foot=[
            *([f"Made from `{project}`."] if project else []),
            "Deviations are tool side minus workpiece side; uncertainties are standard "
            "uncertainties (k = 1) unless stated otherwise.",
        ],
    )
    write_page(folder / "report.html", page)
    return remarks


def study_sections(
    study: Study, pictures: Sequence[Shown], place: str = "", title: str = "", shown_first: str = ""
) -> list[Section]:
    """Sampling, every map, and the errors that dominate in each region.

    Args:
        study: The study.
        pictures: File and caption of every map.
        place: Folder of the maps as seen from the page, with a slash at its end.
        shown_first: File of the map that is shown; the others are folded. All are, without one.
    """
    v, names = study.volumetric, [s.name for s in study.chain.symbols]
    order = {name: i for i, name in enumerate(_ORDER)}
    shown = sorted(pictures, key=lambda one: order.get(one[0], len(_ORDER)))
    rows = [
        [place_words(r.place), digits(r.rms / UM), dominant_words(r, names)]
        for r in regions(study.population, study.workspace)
    ]
    words = (
        f"{sampling_words(v)}; {len(study.q)} poses of the workspace; linear, parabolic and "
        f"sinusoidal errors. Averaged over the poses, the mean volumetric error is "
        f"{um(float(v.mean.mean()))} and its 95 % quantile over machines "
        f"{um(float(v.p95.mean()))}; at the worst pose the quantile is {um(float(v.p95.max()))}. "
        "All figures are first order: the exact product differs by "
        f"{um(study.exact.rms, 2)} rms, measured on {study.exact.machines} machines at "
        f"{study.exact.poses} poses."
    )
    maps = [Picture(f"{place}{name}", caption) for name, caption in shown]
    columns = ("region", "volumetric error, µm rms", "errors")
    first = [one for one in maps if one.file.endswith(shown_first)]
    others = [one for one in maps if one not in first]
    fold = f"{len(others)} more maps"
    return [
        Section(title, sentences=[words], pictures=first),
        Section(table=Table(columns, rows, _VARIANCE)),
        *([Section(fold=fold, is_for_screen=True, pictures=others)] if others else []),
    ]


def draw_study_volumes(
    study: Study,
    folder: Path,
    remarks: list[str],
    mesh: tuple[Array, np.ndarray] | None = None,
    T_table_artefact: Array | None = None,
) -> list[Shown]:
    """Draw volumetric error and S in three dimensions.

    Args:
        remarks: Receives a line if they cannot be drawn, as without OpenGL.
        mesh: Corners and triangles of the standard; None for none.
        T_table_artefact: Pose of the standard, (4, 4).
    """
    if not has_volume(study.workspace):
        remarks.append("No maps in three dimensions: they need three linear axes that can move.")
        return []
    scenes = {
        folder / ERROR_3D: error_scenes(study, T_table_artefact),
        folder / S_3D: sensitivity_scenes(study, T_table_artefact),
    }
    try:
        draw_volumes({path: each for path, each in scenes.items() if each}, mesh)
    except DesignError as error:
        remarks.append(f"No maps in three dimensions: {error}")
        return []
    stands = (
        "The standard is drawn at the readings at which the centre of the probe's ball meets it. "
        if T_table_artefact is not None
        else ""
    )
    how = (
        "Colours on the three far sides and on iso-surfaces between them; each map has its own "
        f"scale. {stands}Dash-dotted: the rotary axes."
    )
    out = [
        (
            ERROR_3D,
            "Volumetric error over the linear readings, 95 % quantile over machines: with the "
            f"table level, and at the rotary readings of the worst pose. {how} {unsampled(study)}",
        )
    ]
    if scenes[folder / S_3D]:
        words = "S of angular errors over the linear readings, table level: the distance from the "
        out.append((S_3D, f"{words}axis of the rotation. {how} Exact to first order."))
    return out


def error_scenes(study: Study, T_table_artefact: Array | None = None) -> list[Scene]:
    """Volumetric error with the table level, and at the rotary readings of the worst pose."""
    worst = {a: float(study.worst_pose[study.chain.axis_index(a)]) for a in study.chain.rotary_axes}
    each = [("table level", level(study.workspace))]
    if worst:
        each.append(("worst pose", worst))
    out = []
    for words, rotary in each:
        box = volume(study.workspace, rotary)
        values = box.volumetric(study.population) / UM
        out.append(_scene(box, words, "95 % quantile in µm", values, T_table_artefact))
    return out


def sensitivity_scenes(study: Study, T_table_artefact: Array | None = None) -> list[Scene]:
    """S of a few errors of large share whose maps differ, each of another link."""
    box = volume(study.workspace, level(study.workspace))
    chosen: list[tuple[Symbol, Array]] = []
    for i in np.argsort(-study.shares.mean(axis=0), kind="stable"):
        symbol = study.chain.symbols[int(i)]
        taken = symbol.link in (other.link for other, _ in chosen)
        if taken or not symbol.is_angular or symbol.family is Family.SETUP:
            continue
        S = box.sensitivity(symbol) / (UM / URAD)
        if shows_more(S, (other for _, other in chosen)):
            chosen.append((symbol, S))
        if len(chosen) == _S_SCENES:
            break
    return [
        _scene(box, f"S of {symbol.name}", "µm/µrad", S, T_table_artefact) for symbol, S in chosen
    ]


def _scene(
    box: Volume, words: str, unit: str, values: Array, T_table_artefact: Array | None
) -> Scene:
    """One map with its readings, axes and standard."""
    at = ", ".join(f"{name} {reading / DEG:.0f}°" for name, reading in sorted(box.rotary.items()))
    first, second, third = (f"{name} in mm" for name in box.axes)
    stands = None if T_table_artefact is None else box.T_readings_table @ T_table_artefact
    return Scene(
        title=f"{words}: {at}" if at else words,
        unit=unit,
        labels=(first, second, third),
        readings=box.readings,
        values=values,
        T_readings_artefact=stands,
        lines=box.lines(),
    )


def parameters_words(chain: Chain) -> str:
    """`71 error parameters: 49 of the axes, 11 of the spindle C1, 11 of set-up and tool`."""
    counts = Counter(_carrier(chain, symbol) for symbol in chain.symbols)
    parts = ", ".join(f"{count} of {name}" for name, count in counts.items())
    return f"{len(chain.symbols)} error parameters: {parts}"


def _carrier(chain: Chain, symbol: Symbol) -> str:
    if symbol.family is Family.SETUP:
        return "the set-up of workpiece and tool"
    link = chain.link(symbol.link)
    return "the axes" if link.programmed else f"{link.name}, which is not programmed"
