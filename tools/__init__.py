"""Developers' tools; they run in the repository and belong to no wheel."""
