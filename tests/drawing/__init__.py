"""Tests of the dimensioned drawings."""
