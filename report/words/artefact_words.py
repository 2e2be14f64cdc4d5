"""Sentences about a design: what its touches were chosen for."""

from artefact.brief import StandardTable

_CRITERIA = {
    "I": "mean variance of the predicted tool point over probed volume and workspace",
    "G": "largest variance of the predicted tool point at any pose of probed volume and workspace",
    "D": "volume of what stays unknown of the parameters, in units of what is expected",
    "A": "mean variance of the parameters, in units of what is expected",
    "E": "variance of the least well determined error pattern, as the tool point feels it",
}


def criterion_words(wanted: StandardTable) -> str:
    """What touches were chosen for."""
    words = [_CRITERIA[wanted.criterion]]
    if wanted.drawn_machines:
        which = "" if wanted.worst_share == 1.0 else f"the worst {percent(wanted.worst_share)} of "
        words.append(f"averaged over {which}{wanted.drawn_machines} drawn machines")
    if wanted.potential and wanted.criterion == "D":
        words.append("with the effects of the library beside them")
    elif wanted.potential:
        words.append(
            f"with a share of {percent(wanted.potential)} for showing effects of the library"
        )
    return ", ".join(words)


def percent(value: float) -> str:
    """A share in percent."""
    return f"{100.0 * value:.1f} %" if abs(value) < 0.1 else f"{100.0 * value:.0f} %"
