"""Effects by name: the register, trials of users' own effects, the ordinary geometric model."""

from twin.library.catalogue import (
    Kind,
    is_seen,
    kinds,
    load_installed_effects,
    load_user_effects,
    parse_effect,
    proposals,
    register,
    users_files,
)
from twin.library.ordinary import ordinary_model
from twin.library.sized_effect import SizedEffect, parse_sized_effect, parse_sizes
from twin.library.trial import fault, try_effect, try_kind, users_lines

__all__ = [
    "Kind",
    "SizedEffect",
    "fault",
    "is_seen",
    "kinds",
    "load_installed_effects",
    "load_user_effects",
    "ordinary_model",
    "parse_effect",
    "parse_sized_effect",
    "parse_sizes",
    "proposals",
    "register",
    "try_effect",
    "try_kind",
    "users_files",
    "users_lines",
]
