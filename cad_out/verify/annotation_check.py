"""Whether a STEP file says and shows what drawing and design say: tolerances, notes, signs."""

from typing import Any

import numpy as np

from matstd.artefact.body import Standard
from matstd.cad_out.details import Details, Tolerance, annotations_of, notes_of, tolerances_of
from matstd.cad_out.verify.part21_tolerances import read_notes, read_signs, read_tolerances
from matstd.twin.frames import Array
from matstd.twin.units import NM


def missing_annotations(
    standard: Standard, details: Details, entities: dict[int, str], found: dict[str, Any]
) -> tuple[str, ...]:
    """Tolerances, notes and signs that the text's reader or the kernel's does not find."""
    of_kernel = {Tolerance(*values) for values in found["tolerances"]}
    both = of_kernel & set(read_tolerances(entities))
    wanted = tolerances_of(standard, details)
    lost = [f"{t.kind} of {t.face}" for t in wanted if t not in both]
    notes = set(found["notes"]) & set(read_notes(entities))
    lost += [
        f"note {n}" for n, note in enumerate(notes_of(standard, details), 1) if note not in notes
    ]
    return (*lost, *_undrawn(annotations_of(standard, details), entities, found["signs"]))


def _undrawn(
    drawn: dict[str, list[Array]], entities: dict[int, str], of_kernel: dict[str, list[float]]
) -> list[str]:
    """Signs that the reader of the text or of the kernel does not find as designed."""
    of_text, lost = read_signs(entities), []
    for name, strokes in drawn.items():
        step = np.concatenate([np.diff(line, axis=0) for line in strokes])
        middle = np.concatenate([0.5 * (line[1:] + line[:-1]) for line in strokes])
        length = np.linalg.norm(step, axis=1)
        whole = [length.sum(), *(length @ middle / length.sum())]
        same = len(of_text.get(name, [])) == len(strokes) and all(
            one.shape == other.shape and np.abs(one - other).max() <= NM
            for one, other in zip(of_text[name], strokes, strict=True)
        )
        if not (same and np.allclose(of_kernel.get(name, np.inf), whole, rtol=0.0, atol=NM)):
            lost.append(f"sign of {name}")
    return lost
