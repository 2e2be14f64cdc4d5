"""What is said of a study: sampling, volumetric error, the errors that make most of it."""

from sensitivity.study import Study
from twin.units import UM

_SHOWN = 5  # parameters with the largest shares


def study_words(study: Study) -> list[str]:
    """The study in a few lines."""
    v = study.volumetric
    lines = [
        v.statement,
        f"volumetric error over {len(study.q)} poses: mean {v.mean.mean() / UM:.1f} µm, "
        f"P95 {v.p95.mean() / UM:.1f} µm, at the worst pose {v.p95.max() / UM:.1f} µm",
    ]
    if v.tolerance < float("inf"):
        lines.append(
            f"beyond {v.tolerance / UM:g} µm: on average {v.exceedance.mean():.1%} "
            f"of the machines, {v.exceedance.max():.1%} at the worst pose"
        )
    ranked = ", ".join(f"{name} {share:.1%}" for name, share in study.ranking()[:_SHOWN])
    lines.append(f"largest shares of the variance: {ranked}")
    return lines


def unsampled(study: Study) -> str:
    """What has to stand beside a volumetric error that was not sampled."""
    mean, worst = study.tail
    return (
        "Without sampling, to first order and as if errors were normally distributed: the 95 % "
        f"quantile that was sampled at {len(study.q)} poses differs from it by {100.0 * mean:+.1f} "
        f"% on average, {100.0 * worst:+.1f} % at worst."
    )
