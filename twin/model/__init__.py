"""What an effect is and how effects add up: columns of the linear model, the exact product.

An effect states where it acts (`Where`) and how much per unit of each parameter (`Term`); `Model`
adds terms up, to first order and exactly. `Declared` writes most of an effect from its fields,
`Kind` is a word of the library with its card, and `traits` answers what others ask of an effect.
"""

from matstd.twin.fields import moving_axes as moving_axes
from matstd.twin.fields import refusal as refusal
from matstd.twin.fields import sensors as sensors
from matstd.twin.machine import Where as Where
from matstd.twin.model.declared import Amounts as Amounts
from matstd.twin.model.declared import Declared as Declared
from matstd.twin.model.declared import scanned as scanned
from matstd.twin.model.effect import Effect as Effect
from matstd.twin.model.effect import Inner as Inner
from matstd.twin.model.effect import Parameter as Parameter
from matstd.twin.model.effect import Term as Term
from matstd.twin.model.effect import Title as Title
from matstd.twin.model.effect import Tunable as Tunable
from matstd.twin.model.effect import contribution as contribution
from matstd.twin.model.effect import inner_values as inner_values
from matstd.twin.model.effect import is_saved as is_saved
from matstd.twin.model.effect import is_tunable as is_tunable
from matstd.twin.model.effect import own_title as own_title
from matstd.twin.model.effect import with_inner as with_inner
from matstd.twin.model.effect_traits import Traits as Traits
from matstd.twin.model.effect_traits import Wave as Wave
from matstd.twin.model.effect_traits import original_of as original_of
from matstd.twin.model.effect_traits import traits as traits
from matstd.twin.model.kind import Kind as Kind
from matstd.twin.model.model import Model as Model
from matstd.twin.model.model import columns as columns
