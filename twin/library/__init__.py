"""Effects by name: the register, trials of users' own effects, the ordinary geometric model.

In: names such as `backlash(X)`, users' Python files, touches. Out: effects, and proposals of all
that make sense for some touches.
"""

from matstd.twin.library.catalogue import (
    find_kinds,
    is_visible,
    kinds,
    load_installed_effects,
    load_user_effects,
    owner_of,
    parse_effect,
    proposals,
    register,
    title_of,
    users_files,
)
from matstd.twin.library.ordinary import ordinary_model
from matstd.twin.library.sized_effect import parse_sized_effect, parse_sizes
from matstd.twin.library.trial import try_effect, try_kind, users_fault, users_lines

__all__ = [
    "find_kinds", "is_visible", "kinds", "load_installed_effects", "load_user_effects",
    "ordinary_model", "owner_of", "parse_effect", "parse_sized_effect", "parse_sizes", "proposals",
    "register", "title_of", "try_effect", "try_kind", "users_fault", "users_files", "users_lines",
]  # fmt: skip
