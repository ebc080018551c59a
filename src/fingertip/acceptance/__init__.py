"""Acceptance of a finger: tests of its sensor before and after casting, and of the finished finger."""
