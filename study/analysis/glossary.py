"""What the planners' names mean, in a line each."""

from __future__ import annotations

from collections.abc import Iterable

PRINTED = "-as-printed"

WHAT = {
    "adf-ssa": "sparrow search with adaptive steps",
    "any-motion-bound": "no planner but a proof: a time that no motion through the waypoints can undercut",
    "bspline-nlp": "one B-spline through the waypoints, its control points optimised by IPOPT",
    "casadi-nlp": "segment durations by nonlinear programming (CasADi and IPOPT)",
    "centre": "no search at all: the middle of the box of durations, stretched to the limits",
    "certified": "the global optimum on the curve by branch and bound, with a proof",
    "cfpso": "particle swarm with a constriction factor",
    "chaotic-spso": "particle swarm with a chaotic start and weights that change in two stages, of the PUMA560 paper",
    "cma-es": "covariance matrix adaptation, the usual strong evolution strategy",
    "copp": "speed along a given path with a jerk limit, by cone programs (COPP)",
    "de": "differential evolution",
    "direct": "DIRECT of SciPy: divides the box of durations, draws no random number",
    "dynamic-adaptive-pso": "particle swarm whose weights change with the generation, of the AUBO paper",
    "free-path": "free path in short pieces of polynomials with widths of their own, optimised by an interior point of the project",
    "free-path-nlp": "free path in short pieces of polynomials, optimised by IPOPT",
    "gold-sa": "golden sine search",
    "golds-pso": "particle swarm without velocities, with a golden sine step, of the woodworking paper",
    "gsa": "gravitational search",
    "lbfgsb": "gradient descent (L-BFGS-B of SciPy), started again and again until the budget is spent",
    "lbfgsb-once": "gradient descent (L-BFGS-B of SciPy), once, from equal durations",
    "pso": "the standard particle swarm",
    "pso-basic": "particle swarm with constant weights, as the woodworking paper describes the basic one",
    "quintic-nlp": "quintic segments with free velocities and accelerations at the waypoints, optimised by IPOPT",
    "random-search": "durations drawn blindly, the best kept; what any search must beat",
    "ruckig-stops": "Ruckig from waypoint to waypoint, with a stop at each",
    "ruckig-via": "Ruckig through the waypoints without stopping, the states there optimised",
    "sca": "sine cosine search",
    "scipy-de": "differential evolution of SciPy",
    "simple-pso": "particle swarm without velocities",
    "sma": "slime mould search",
    "smwoa": "whale search with parts of slime mould search, of the UR5 paper",
    "ssa": "sparrow search",
    "stoa": "sooty tern search",
    "t-ssa": "sparrow search with a chaotic start",
    "tadf-ssa": "sparrow search with a chaotic start and adaptive steps, of the improved sparrow paper",
    "topp3-nlp": "speed along a given path with a jerk limit, by IPOPT",
    "toppra": "TOPP-RA: the fastest speed along a given path, without a jerk limit",
    "woa": "whale search",
}


def glossary(planners: Iterable[str]) -> dict[str, str]:
    """Explain planners, by name; what other packages bring is left out."""
    known = sorted({name for name in planners if name.removesuffix(PRINTED) in WHAT})
    return {name: _explained(name) for name in known}


def _explained(name: str) -> str:
    base = name.removesuffix(PRINTED)
    return WHAT[base] if name == base else f"{WHAT[base]}; its formulas exactly as printed, misprints included"
