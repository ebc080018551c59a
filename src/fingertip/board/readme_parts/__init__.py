"""Sections of the README of a board."""
