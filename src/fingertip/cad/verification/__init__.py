"""Verification of built parts: topology of files, identities between parts, clearances, walls and
strength.

In: a design and its `Solids`. Out: records of value and limit, listed by `verify`; `check` says how
one registers.

>>> from fingertip.cad.verification.verify import list_causes
>>> list_causes("mold.wall")
('mold.wall_mm', 'mold.engraving_depth_mm')
"""
