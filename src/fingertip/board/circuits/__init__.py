"""Circuits of all board variants, as components, pins and nets."""
