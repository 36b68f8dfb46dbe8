"""Plan a motion of one's own, compare planners, write the result for ROS 2."""

import numpy as np

from study import JointLimits, Problem, compare, plan

waypoints = np.array([[0.0, 0.2], [0.5, -0.1], [0.9, 0.3], [1.4, 0.1]])  # rad
limits = JointLimits(velocity=np.array([1.0, 0.8]), acceleration=np.array([2.0, 1.5]), jerk=np.array([20.0, 15.0]))
problem = Problem("mine", waypoints, limits)

best = plan(problem)
print(f"{best.planner}: {best.duration:.4f} s, because {best.why}")
print(compare(problem, ["casadi-nlp", "golds-pso", "ruckig-stops"]))
best.write("mine.trajectory.yaml", rate=250)
