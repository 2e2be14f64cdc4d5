"""What the result of a page means for the use of the machine, in the box below its head."""

from collections.abc import Mapping

import numpy as np

from matstd.diagnosis.answer import Comparison, Diagnosis, Verdict
from matstd.diagnosis.task import TaskUncertainty
from matstd.report.numbers import microns, plural, um
from matstd.sensitivity.study import Study
from matstd.twin.words import listed


def diagnosis_meaning(result: Diagnosis) -> str:
    """May the model be used, and how well does it predict."""
    before, after = (microns(p.elsewhere) for p in (result.promise_before, result.promise))
    touched = f"the model predicts the tool point to {after} rms within what was probed"
    if result.verdict is Verdict.NONE:
        return (
            f"The model describes the machine as far as this run shows: {touched}. It may be used "
            "to correct the machine in the state in which it was probed."
        )
    laws = result.laws if result.laws is not None and result.laws.laws else None
    of_library = [] if laws is None else laws.of_library
    if of_library and (result.withdrawn or result.verdict is Verdict.UNEXPLAINED):
        return (
            f"What acts on the machine is in the library: {listed(of_library, 'and')}. The learnt "
            "law describes it no better and stands for it until the effect is added. Without it "
            f"predictions are off by {before} rms; with it {touched}."
        )
    if result.withdrawn:
        return (
            "Something acts on the machine that no effect of the library accounts for; effects of "
            f"it only imitate the learnt law. Without the law predictions are off by {before} rms; "
            f"with it {touched}."
        )
    if result.verdict is Verdict.MISSING:
        count = plural(sum(s.effect is not None for s in result.steps), "effect")
        return (
            f"The machine has {count} that the starting model lacks. Without it parts made in "
            f"other states (warm, other direction, other place) differ from the prediction by "
            f"{before} rms; with it {touched}."
        )
    if result.verdict is Verdict.UNEXPLAINED and laws is not None:
        return (
            "Something acts on the machine that no effect of the library accounts for. The learnt "
            "law describes it and model.toml predicts with it, within the range that was probed. "
            f"Without it predictions are off by {before} rms; with it {touched}."
        )
    if result.verdict is Verdict.UNEXPLAINED:
        return (
            "Something acts on the machine that no effect of the library accounts for. "
            f"Predictions are off by {after} rms, and a compensation by this model leaves that."
        )
    if result.found:
        return (
            "This run does not decide whether the machine has an effect that the starting model "
            f"lacks. Without it predictions are off by {before} rms; with it {touched}."
        )
    return (
        "This run does not decide whether what remains is noise or an effect: the noise would have "
        "to be far above what is stated, and no touch is repeated."
    )


def comparison_meaning(found: Comparison) -> str:
    """Whether the model may be used for the machine as it is now."""
    what = "prediction" if found.is_prediction else "fit"
    if found.is_noise:
        return (
            f"The {what} leaves {microns(found.rms)} rms without any pattern: the model holds for "
            "the machine as this run found it."
        )
    if not (found.structure or found.where):
        return (
            f"The {what} leaves {microns(found.rms)} rms without any pattern, more than the stated "
            "uncertainty: the noise is larger than stated, or the machine differs from the model."
        )
    return (
        f"The {what} leaves {microns(found.rms)} rms with a pattern that is not due to chance. "
        "Where and when it acts, parts are wrong by more than the noise; a compensation by this "
        "model leaves it."
    )


def uncertainty_meaning(found: Mapping[str, TaskUncertainty]) -> str:
    """What may be stated of a measured part."""
    best = min(found, key=lambda name: found[name].U)
    return (
        f"A result of this task measured on this machine is known to ± {um(found[best].U)} (95 %), "
        f"{best}. Parts nearer to a limit than that are neither proved good nor proved bad."
    )


def study_meaning(study: Study) -> str:
    """Which errors are worth an effort, and where."""
    names = [symbol.name for symbol in study.chain.symbols]
    share = study.shares.mean(axis=0)
    first = [names[int(k)] for k in np.argsort(-share)[:3]]
    return (
        f"Of machines with the stated error ranges {', '.join(first)} move the tool point most. "
        "Measure and adjust these first; place accurate work where the maps are light."
    )
