"""What to do with a result, in one sentence: the last of the first screen."""

import shlex

from matstd.diagnosis.answer import Comparison, Diagnosis, Doubt, Verdict
from matstd.report.numbers import plural


def diagnosis_step(result: Diagnosis, title: str, is_saved: bool = False) -> str:
    """After a diagnosis; `is_saved` where the model file has what was found."""
    if result.verdict is Verdict.UNDECIDED and result.found:
        if all(one.doubt is Doubt.SMALL for one in result.parts.named):
            return "Go on with the starting model: with what was found it predicts hardly better."
        return (
            "Probe at further readings of the axes and diagnose both runs together; they decide "
            "between the effect and errors of the machine that do the same here."
        )
    if result.verdict is Verdict.UNDECIDED:
        what = plural(len(result.repeat), "touch") if len(result.repeat) else "some touches"
        return f"Repeat {what}; their scatter decides whether the residual is noise."
    is_unexplained = result.verdict is Verdict.UNEXPLAINED
    if result.laws is not None and result.laws.laws and (is_unexplained or result.withdrawn):
        if result.laws.of_library:
            adds = " ".join(f'--add "{name}"' for name in result.laws.of_library)
            return f"`matstd diagnose {_files(title)} {adds}` puts the effect into model.toml."
        auto = f"`matstd diagnose {_files(title)} --auto`"
        until = (
            "model.toml predicts with it until then."
            if is_unexplained or is_saved
            else f"{auto} puts the law into model.toml until then."
        )
        return (
            "Look for the cause of the learnt law, rename it in effect.py, and diagnose "
            f"again with `--effects effect.py`. {until}"
        )
    if is_unexplained and result.laws is not None:
        return "Record what could cause it (a temperature, a load), and diagnose again."
    if is_unexplained:
        return (
            f"`matstd learn {_files(title)}` looks for a law of what remains. Where none holds, "
            "record what could cause it (a temperature, a load), and diagnose again."
        )
    if result.verdict is Verdict.NONE:
        return "Add no effect; `matstd compensate` returns the model to the machine."
    them = "it" if len(result.steps) == 2 else "them"
    probe = "; probe `next_measurement_1.csv` to learn which cause it is" if result.plans else ""
    if is_saved:
        return f"`matstd compensate` returns model.toml to the machine{probe}."
    return (
        f"`matstd diagnose {_files(title)} --auto` puts {them} into model.toml, and "
        f"`matstd compensate` returns the model to the machine{probe}."
    )


def _files(title: str) -> str:
    """The runs of a title as a command line has them: blanks need quotation marks."""
    return " ".join(shlex.quote(name) for name in title.split(", "))


def comparison_step(found: Comparison, title: str) -> str:
    """After a comparison; arguments as of `diagnosis_step`."""
    if found.is_noise:
        return "Nothing; the model describes this run down to its noise."
    return f"`matstd diagnose {_files(title)} --auto` looks for the effect that the model lacks."
