"""Runs of scenes with one finger, and of manipulations with a hand that holds an object while a pin hits it."""
