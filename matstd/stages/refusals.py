"""Refusals of a design as one line that helps, and the picture that it leaves to the user."""

from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

from matstd.artefact.brief import FEWEST_PATCHES, Brief
from matstd.twin.errors import DesignError, NotBuildable, NotReachable

REACH, ROOM = "reach.png", "room.png"
"""Pictures of what the machine reaches, and of the patches that fit side by side."""

REFUSED_REACH, REFUSED_ROOM = "reach-refused.png", "room-refused.png"
"""The same pictures, all that a refused run leaves in its folder."""

_KEYS = {
    "smallest concave radius": "limits.min_concave_radius_mm (smaller)",
    "slope": "limits.max_slope_deg (larger)",
    "height": "blank.height_mm (larger)",
    "room for the ball before": "limits.gap_mm or probe.radius_mm (smaller)",
    "distance of the stem from": "limits.gap_mm or probe.radius_mm (smaller)",
    "mass": "limits.max_mass_kg (larger)",
    "slots": "limits.slot_pitch_mm (smaller, or 0)",
}
"""What may be changed where a constraint binds."""

_ALWAYS, _LIGHTER = "blank.base_mm and blank.height_mm (larger)", "blank.base_mm (smaller)"

_NOTHING = (
    "no change of standard.patches, limits or blank.base_mm alone would do of those that were tried"
)


@contextmanager
def refusals(brief: Brief, folder: Path, out: str | Path) -> Iterator[None]:
    """Make whatever stops a design one line that helps; pictures of it lie in `folder`."""
    try:
        yield
    except NotBuildable as error:
        reason = f"{brief.path}: {error}; {_what_helps(error)}"
        seen = _keep_picture(folder / ROOM, Path(out) / REFUSED_ROOM, "what fits")
        raise NotBuildable(reason + seen) from error
    except NotReachable as error:
        reason = str(error)
        if not reason.startswith(str(brief.path)):
            reason = f"{brief.path}: {reason}; change workspace, setup or probe.length_mm"
        seen = _keep_picture(folder / REACH, Path(out) / REFUSED_REACH, "what is reached")
        raise NotReachable(reason + seen) from error


def _keep_picture(picture: Path, there: Path, shows: str) -> str:
    """Leave a picture to the user if there is one, and say so."""
    if not picture.exists():
        return ""
    there.parent.mkdir(exist_ok=True)
    picture.replace(there)
    return f"; {there} shows {shows}"


def _what_helps(error: DesignError) -> str:
    """Changes that were tried and would do, or keys of the project file, the likeliest first."""
    if "exit_code" in error.facts and error.facts["exit_code"] is None:
        return "run it again when the machine is less busy"
    if error.facts.keys() & {"conformity", "exit_code"}:
        return "change seed: the fault is the tool's own, not the project's"
    fitting, binding = error.facts.get("fitting"), error.facts.get("binding")
    wishes = error.facts.get("wishes")
    if isinstance(wishes, list):
        return f"{' or '.join(wishes)} would do" if wishes else _NOTHING
    keys = []
    if isinstance(fitting, int):
        if fitting >= FEWEST_PATCHES:
            keys.append(f"standard.patches (to {fitting})")
        keys.append(_KEYS["room for the ball before"])
    keys += [_KEYS.get(name, _ALWAYS) for name in binding] if isinstance(binding, list) else []
    last = _LIGHTER if binding == ["mass"] else _ALWAYS
    return f"change {' or '.join(dict.fromkeys([*keys, last]))}"
