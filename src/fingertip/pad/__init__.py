"""Pad of the finger: what part of a force reaches the sensor, by a layer model and by finite
elements.

The form of the pad and a pose on an object come in; contact force, depth and the sensor's share of
it go out.

>>> from fingertip.pad.touch import Pose
>>> Pose(tilt_deg=5.0)
Pose(tilt_deg=5.0, roll_deg=0.0, object='plate', radius_mm=0.0, place_mm=0.0, across_mm=0.0)
"""
