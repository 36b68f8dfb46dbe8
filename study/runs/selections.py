"""Selections of planners: the one place where planners are named by taste; everything else they say themselves."""

MODERN_SEARCHES = ("cma-es-own-population", "cma-es", "l-shade")
"""References of no paper that stand for what metaheuristics can do today; the first takes its own population size, the
others the paper's."""

OF_NO_PAPER = (*MODERN_SEARCHES, "l-shade-own-population", "scipy-de")
"""Searches that no paper proposes or compares with; those of other packages count with them."""

HEADLINE_SEARCHES = (
    "pso",
    "gold-sa",
    "golds-pso",
    "dynamic-adaptive-pso",
    "smwoa",
    "tadf-ssa",
    "chaotic-spso",
    *MODERN_SEARCHES,
    "random-search",
)
"""Searches of the default line-up; every deterministic planner stands beside them."""

COMPARED = ("free-path", "ruckig-via", "casadi-nlp", "toppra", "ruckig-stops", "golds-pso", "random-search")
"""Planners for a case of one's own: every deterministic kind, one metaheuristic and the floor."""

DIRECT = ("ruckig-stops",)
"""Planner that is tried first, and alone if it succeeds, where a single move from rest to rest is asked for: its move is
then the fastest of all."""

FAST = ("toppra-quick", "free-path-first", "ruckig-stops")
"""Planners that the tier `fast` tries in turn until a motion is feasible; the first, without a jerk limit only."""

AUTO = ("free-path", "ruckig-stops")
"""Planners that the tier `best` tries by itself; the fastest motion of all is the answer, and the last always has one."""

AUTO_WITHOUT_JERK = ("toppra-quick", *AUTO)
"""The same where no joint has a jerk limit: with the planner of `fast`, so that `best` never ends above it."""

AUTO_RESERVE = ("ruckig-via", "casadi-nlp")
"""Planners that are tried too where those above bring nothing but a stop at every waypoint."""

AUTO_ON_LINES = ("straight", "free-path", "ruckig-stops")
"""Planners that `plan` tries by itself where the path between the waypoints must be straight, or nearly so."""

AUTO_UNBOUNDED = ("free-path-nlp", "ruckig-stops")
"""Planners that `plan` tries where only velocities are limited: straight lines at full speed are then the optimum."""

YARDSTICKS = ("random-search", "centre", "lbfgsb-once")
"""Trivial ways to choose durations, which any search must beat."""

CONTESTANTS = (
    "pso", "pso-basic", "simple-pso", "gold-sa", "golds-pso", "dynamic-adaptive-pso", "woa", "sma", "smwoa", "ssa",
    "tadf-ssa", "chaotic-spso", "de", *MODERN_SEARCHES, "scipy-de",
)  # fmt: skip
"""Searches that are compared at equal budgets."""

SOLVERS = ("casadi-nlp", "direct", "lbfgsb", "ruckig-stops", "toppra")
"""Planners that are compared with the searches on wall time and duration only."""

SLOW_SOLVERS = ("ruckig-via",)
"""Solvers of the full comparison only."""

REPEATED = ("ruckig-stops",)
"""Planners so fast that their wall time is the median of several calls; the first call loads a library."""

TIMED = ("casadi-nlp", "toppra", "ruckig-stops", "ruckig-via", "copp")
"""Planners whose speed the bench measures."""
