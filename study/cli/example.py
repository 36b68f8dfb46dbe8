"""The commented example that `study init` writes: a 7-joint arm through 10 waypoints."""

EXAMPLE = """\
# A problem of your own. Check it with `study check`, plan with `study plan`, compare planners with `study compare`.
# For completion in your editor: study schema > case.schema.json, and keep the next line.
# yaml-language-server: $schema=case.schema.json

version: 1
name: NAME

# Units of all numbers in this file, and of CSV files that it names: rad or deg; m or mm for joints that slide.
# One for all joints, or a list with one for each.
units: deg

# Names of the joints, in the order of the columns below (optional).
joints: [shoulder_pan, shoulder_lift, upper_arm, elbow, forearm, wrist_flex, wrist_roll]

# One row for each waypoint; or the name of a file, such as
#   waypoints: waypoints.csv      a table, with or without a header of joint names; also YAML or JSON rows
#   waypoints: taught.yaml        a ROS 2 trajectory_msgs/JointTrajectory, whose positions are rad and m
waypoints:
  - [0, -30, 0, -90, 0, 45, 0]
  - [15, -20, 10, -80, 10, 50, 20]
  - [30, -5, 15, -60, 15, 40, 35]
  - [40, 10, 5, -50, 5, 30, 40]
  - [35, 25, -10, -65, -10, 35, 25]
  - [20, 30, -20, -85, -20, 50, 5]
  - [0, 20, -15, -100, -10, 60, -15]
  - [-20, 5, 0, -95, 5, 55, -30]
  - [-30, -15, 10, -80, 15, 40, -20]
  - [-25, -30, 0, -70, 0, 30, 0]

# Limits per second, second squared and second cubed: one number for all joints or one for each (null: none).
# They may also come from files, which numbers given here overrule:
#   from: joint_limits.yaml                 MoveIt
#   from: [robot.urdf, joint_limits.yaml]   URDF: velocity and position limits; later files win
limits:
  velocity: [85, 85, 100, 75, 130, 135, 135]
  acceleration: 300
  jerk: 3000
  position:                       # may lie unevenly about zero
    lower: [-170, -120, -170, -170, -170, -10, -175]
    upper: [170, 120, 170, 0, 170, 215, 175]

# rest: zero velocity at both ends; smooth: zero acceleration too; free: neither.
end: smooth

# For 3D in the recording: a URDF, a file with a DH table, or one of the study's arms. Then obstacles can be given as boxes
# in the robot's base frame, in m.
# robot: robot.urdf
# obstacles:
#   - {lower: [0.3, -0.2, 0.0], upper: [0.5, 0.2, 0.4]}
"""
