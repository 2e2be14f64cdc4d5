"""What moves on the page of a design: the standard, its touches, error field, rivals, sensitivity.

In: the brief, the placement, the plan of touches, and the first simulated machine with its
identified model. Out: the `LiveView` of the page, with data for `live/pages/design_page.js`.
"""

from matstd.report.design_view.live_design import DesignScene as DesignScene
from matstd.report.design_view.live_design import design_live as design_live
from matstd.report.design_view.live_design import error_field as error_field
