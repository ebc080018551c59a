"""Skin on a surface: friction, travel, vibration, and the steppers that solve them."""
