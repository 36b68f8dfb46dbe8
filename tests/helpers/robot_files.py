"""Shared by the tests: robot files."""

MOVEIT = """\
default_velocity_scaling_factor: 0.1
joint_limits:
  panda_joint1:
    has_velocity_limits: true
    max_velocity: 2.175
    has_acceleration_limits: true
    max_acceleration: 3.75
    has_jerk_limits: false
    max_jerk: 7500
  "joint <2>":
    max_velocity: 1e0
    has_position_limits: true
    min_position: -0.5
    max_position: 2.0
"""


URDF = """\
<?xml version="1.0" encoding="utf-8"?>
<robot name="bench">
  <link name="world"/><link name="base"/><link name="l1"/><link name="l2"/><link name="l3"/><link name="tool"/><link name="lamp"/>
  <joint name="mount" type="fixed"><origin xyz="0 0 0.4" rpy="0 0 1.5707963267948966"/><parent link="world"/><child link="base"/></joint>
  <joint name="turn" type="revolute">
    <origin xyz="0 0 0.1"/><axis xyz="0 0 2"/><parent link="base"/><child link="l1"/>
    <limit lower="-1.5" upper="2.5" velocity="3.14" effort="10"/>
  </joint>
  <joint name="slide" type="prismatic">
    <origin xyz="0.2 0 0" rpy="0 1.5707963267948966 0"/><axis xyz="1 0 0"/><parent link="l1"/><child link="l2"/>
    <limit lower="0" upper="0.6" velocity="0.25" effort="10"/>
  </joint>
  <joint name="spin" type="continuous"><axis xyz="0 1 0"/><parent link="l2"/><child link="l3"/><limit velocity="6" effort="1"/></joint>
  <joint name="flange" type="fixed"><origin xyz="0 0 0.1"/><parent link="l3"/><child link="tool"/></joint>
  <joint name="lamp holder" type="fixed"><parent link="base"/><child link="lamp"/></joint>
</robot>
"""
