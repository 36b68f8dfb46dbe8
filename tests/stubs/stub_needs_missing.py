"""A planner whose package is not installed."""

import a_package_that_nobody_has

PLANNER = a_package_that_nobody_has.PLANNER
