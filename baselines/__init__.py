"""Deterministic references on the same waypoints and limits; `study` finds them through entry points only.

Every planner knows limits of velocity, acceleration and jerk, unless the table says otherwise; the judge measures all.

================ ================================================ ================================= ====================
name             question                                         method                            limits known
================ ================================================ ================================= ====================
casadi-nlp       shortest segment durations on the case's curve   IPOPT, points exchanged           rates
certified        the same, with a proved lower bound              branch and bound                  rates
quintic-nlp      shortest quintic segments, rates free at points  IPOPT, points exchanged           rates
toppra           fastest along a fixed path                       TOPP-RA                           no jerk
topp3-nlp        fastest along a fixed path with jerk limits      IPOPT                             rates
copp             the same                                         cone programs (extra `copp`)      rates, all finite
straight         straight lines, corners cut within a tolerance   passes over the corners' speeds   see its `knows`
ruckig-stops     a stop at every waypoint                         Ruckig, state to state            see its `knows`
ruckig-via       through the waypoints with Ruckig's moves        linear programs over via states   rates
free-path-nlp    any motion through the waypoints                 IPOPT, equal pieces               rates
free-path        any motion through the waypoints                 interior point, pieces per joint  see its `knows`
bspline-nlp      any motion on one B-spline                       IPOPT, limits on control points   rates, some beyond v
any-motion-bound no motion at all: a proved lower bound           cells of velocity, duality        rates
================ ================================================ ================================= ====================

Folders: `segment_times` (durations on a curve), `path_timing` (speed along a path), `state_to_state` (Ruckig),
`free_path`, `bounds`, and `peers` (other packages, not in the table). Shared: `base` (still joints, joints alone),
`units`, `ipopt` (CasADi in one thread at a time), `closed_forms`.
"""
