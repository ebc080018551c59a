"""Signals beyond the campaign's own scenes: what a real hand, its controller and its converter do to a detector."""
