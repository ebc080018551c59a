"""Placer: it moves components, rotations and labels by simulated annealing. It made the boards' placements."""
