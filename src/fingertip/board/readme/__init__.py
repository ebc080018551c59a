"""The README of the folder a board is written to."""
