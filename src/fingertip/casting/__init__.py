"""Casting of the skin: what to mix, what to buy, and every figure of the casting sheet, whose text
is in `documents`.

In: a design, and an evaluator of meshes. Out: a frozen `CastingSheet`, rounded as a person weighs
and measures.

>>> from fingertip.casting.mixture import mix
>>> from fingertip.catalogues.materials import load_silicones
>>> mix(load_silicones()["smooth_sil_940"], 40.0).total_g  # cm3 in the mold -> g in the paper cup
59.0
"""
