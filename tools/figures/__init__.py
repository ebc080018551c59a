"""Figures on pages: what each rests on, the command that renews it, and whether that has changed
since.

`figures.toml` is the manifest. `python -m tools.figures` lists what is old, and `python -m
tools.figures renew NAME` runs the command of an entry, corrects its sentences and tables, and
records the hash of what they rest on.
"""
