"""Pictures of trajectories: what the errors of one axis do, and what random machines do."""

from pathlib import Path

import numpy as np

from matstd.report.style import INK, Axes, Figure, figure, plain, reading_label, save, series
from matstd.report.words import sampling_words
from matstd.sensitivity.montecarlo import Volumetric
from matstd.sensitivity.study import AlongPath, Study, Trajectory
from matstd.twin.frames import Array
from matstd.twin.model import Effect, traits
from matstd.twin.numbers import rms
from matstd.twin.units import UM, URAD

_SHOWN = 6  # errors with a line of their own


def axis_effect_picture(effect: AlongPath) -> tuple[Figure, str]:
    """Effect of some errors along a trajectory, together and each alone, with its caption."""
    path = effect.trajectory
    drawn, axes, beside = _sheet(path)
    axes.plot(path.along, effect.size / UM, color=INK, lw=2.4, label="together")
    for k, name in enumerate(effect.dominant[:_SHOWN]):
        axes.plot(path.along, effect.each[name] / UM, color=series(k), lw=1.4, label=name)
    _finish(axes)
    for k, (letter, d) in enumerate(zip("xyz", effect.deviation.T, strict=True)):
        beside.plot(path.along, d / UM, color=series(k), lw=1.4, label=letter)
    _finish(beside)
    beside.set_ylabel("deviation in x, y, z of the table in µm")
    first = effect.dominant[0] if effect.dominant else "nothing"
    caption = (
        f"Effect of {_words(effect)} along a trajectory ({path.name}, {len(path.q)} poses), exact: "
        f"at most {effect.size.max() / UM:.1f} µm, {rms(effect.size) / UM:.1f} µm rms; {first} "
        "contributes most."
    )
    return drawn, caption


def statistics_picture(
    path: Trajectory, found: Volumetric, closed_p95: Array
) -> tuple[Figure, str]:
    """Volumetric error of random machines along a trajectory, with its caption."""
    drawn, axes, beside = _sheet(path)
    axes.fill_between(
        path.along, found.quantile[0] / UM, found.quantile[-1] / UM, color=series(0), alpha=0.18,
        lw=0, label="P50 to P99",
    )  # fmt: skip
    axes.plot(path.along, found.mean / UM, color=series(0), lw=1.8, label="mean")
    axes.plot(path.along, found.p95 / UM, color=series(1), lw=1.8, label="P95")
    axes.plot(path.along, closed_p95 / UM, ":", color=INK, lw=1.2, label="P95 if all were normal")
    _finish(axes)
    beside.plot(path.along, 100.0 * found.recurrence, color=series(2), lw=1.6,
                label="among the worst 5 %")  # fmt: skip
    if np.isfinite(found.tolerance):
        beside.plot(path.along, 100.0 * found.exceedance, color=series(3), lw=1.6,
                    label=f"beyond {found.tolerance / UM:.6g} µm")  # fmt: skip
    _finish(beside)
    beside.set_ylabel("share of the machines in %")
    caption = f"Volumetric error along a trajectory ({path.name}, {len(path.q)} poses)."
    return drawn, f"{caption} {sampling_words(found)}."


def _sheet(path: Trajectory) -> tuple[Figure, Axes, Axes]:
    """Two diagrams over the way, and below them the readings."""
    drawn = figure(4.8)
    grid = drawn.subplots(2, 2, sharex=True, height_ratios=(3.0, 1.0))
    for below in grid[1]:
        for k, name in enumerate(path.moving):
            label, unit = reading_label(path.chain, name)
            reading = path.q[:, path.chain.axis_index(name)] / unit
            below.plot(path.along, reading, color=series(k), lw=1.2, label=label)
        below.set(xlabel="share of the way", ylabel="reading")
        below.legend(frameon=False, fontsize=7, ncols=3, loc="lower center",
                     bbox_to_anchor=(0.5, 0.98))  # fmt: skip
        _plain(below)
    grid[0, 0].set_ylabel("volumetric error in µm")
    return drawn, grid[0, 0], grid[0, 1]


def _finish(axes: Axes) -> None:
    low, high = axes.get_ylim()
    span = max(high, 1e-3)
    axes.set_ylim(min(low, 0.0), 1.28 * span)
    axes.legend(frameon=False, fontsize=8, ncols=3, loc="upper center")
    _plain(axes)


def _plain(axes: Axes) -> None:
    plain(axes)
    axes.margins(x=0.0)


def _words(effect: AlongPath) -> str:
    """Errors with shapes and amplitudes, where they are few and of the common kind."""
    parts = [_error_words(e, float(np.atleast_1d(a)[0])) for e, a in effect.errors[:8]]
    return ", ".join(parts) + (" and others" if len(effect.errors) > 8 else "")


def _error_words(effect: Effect, size: float) -> str:
    own = traits(effect)
    symbol = own.symbol
    if symbol is None:
        return effect.name
    value = f"{size / URAD:.3g} µrad" if symbol.is_angular else f"{size / UM:.3g} µm"
    shape = f", {own.distribution}" if own.distribution else ""
    return f"{symbol.name} ({value}{shape})"


def draw_path(study: Study, folder: Path) -> list[tuple[str, str]]:
    """Draw what random machines and single axes do along the trajectory of a study.

    Returns:
        File name and caption of each; none where nothing moves.
    """
    if study.path is None:
        return []
    way, out = study.path.trajectory, []
    for effect in study.path.effects:
        drawn, caption = axis_effect_picture(effect)
        out.append((f"trajectory_{effect.axis}.png", caption, drawn))
    drawn, caption = statistics_picture(way, study.path.volumetric, study.path.closed.p95)
    out.append(("trajectory.png", caption, drawn))
    for name, _, drawn in out:
        save(drawn, folder / name)
    return [(name, caption) for name, caption, _ in out]
