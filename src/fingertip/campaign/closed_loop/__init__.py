"""The article's manipulations, with a detector in the loop."""
