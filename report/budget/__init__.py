"""Page of the uncertainty of a measuring task.

In: budgets by what results are corrected with. Out: one HTML file, its tables beside it.
"""

from report.budget.budget_page import write_uncertainty_page

__all__ = ["write_uncertainty_page"]
