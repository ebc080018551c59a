"""Stages of a scene: each computes one quantity, and only those that the recorded outputs need run."""
