"""Effects by name: the register, trials of users' own effects, the ordinary geometric model.

In: names such as `backlash(X)`, users' Python files, touches. Out: effects, and proposals of all
that make sense for some touches.
"""

from matstd.twin.library.catalogue import find_kinds as find_kinds
from matstd.twin.library.catalogue import is_visible as is_visible
from matstd.twin.library.catalogue import kinds as kinds
from matstd.twin.library.catalogue import load_installed_effects as load_installed_effects
from matstd.twin.library.catalogue import load_user_effects as load_user_effects
from matstd.twin.library.catalogue import ordinary_model as ordinary_model
from matstd.twin.library.catalogue import owner_of as owner_of
from matstd.twin.library.catalogue import parse_effect as parse_effect
from matstd.twin.library.catalogue import proposals as proposals
from matstd.twin.library.catalogue import register as register
from matstd.twin.library.catalogue import title_of as title_of
from matstd.twin.library.catalogue import users_files as users_files
from matstd.twin.library.sized_effect import parse_sized_effect as parse_sized_effect
from matstd.twin.library.sized_effect import parse_sizes as parse_sizes
from matstd.twin.library.trial import try_effect as try_effect
from matstd.twin.library.trial import try_kind as try_kind
from matstd.twin.library.trial import users_fault as users_fault
from matstd.twin.library.trial import users_lines as users_lines
