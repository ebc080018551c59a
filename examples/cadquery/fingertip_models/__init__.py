"""Parametric models of the fingertip: everything from parameters to solids, and nothing else.

Each part is a function of a finger: `bone.bone`, `skin.skin`, `mold.mold_palmar`,
`mold.mold_dorsal`, `core.core`, `stand.stand`, `pin.pin` and `hand_stub.hand_stub`. It takes the
tables of parameters and the lengths that follow from them, and returns a solid of `solids`.
`workplanes` makes CadQuery workplanes of solids.

The package stands alone: it imports the standard library and itself, and CadQuery in `workplanes`.
`fingertip build DESIGN --formats cq` copies this folder, as it is, beside the scripts of the parts;
`examples/cadquery` holds them.

>>> from fingertip import Design
>>> from fingertip.models.skin import skin
>>> type(skin(Design())).__name__
'Shell'
"""
