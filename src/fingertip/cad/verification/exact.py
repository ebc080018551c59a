"""The mold's identities on exact volumes: what the B-rep kernel measured must add up without any mesh."""

from __future__ import annotations

import math
from collections.abc import Collection, Iterator, Mapping
from itertools import pairwise

from fingertip.cad.files.step import Exact
from fingertip.cad.shapes import mold
from fingertip.cad.shapes.core import cast_around
from fingertip.cad.shapes.skin import cavity
from fingertip.cad.solids import Box, Cone, Prism, Solid, intersection
from fingertip.cad.verification.checks import HALVES, Check
from fingertip.design import Design
from fingertip.design.mold_layout import MoldLayout, lay_out

RELATIVE = 2e-6
"""What the kernel's volumes may be off by: it integrates to 1e-6."""


def hollows(design: Design, parts: Collection[str]) -> tuple[tuple[str, Solid], ...]:
    """Solids whose exact volumes the identities between these parts need, by name."""
    found: list[tuple[str, Solid]] = []
    if "skin" in parts:
        found += [("cavity", cavity(design)), ("core_in_cavity", intersection(cavity(design), cast_around(design)))]
    if set(HALVES) <= set(parts):
        found.append(("openings", intersection(mold.openings(design), mold.block(design))))
    return tuple(found)


def of_volumes(design: Design, parts: Mapping[str, Exact], hollow_mm3: Mapping[str, float]) -> Iterator[Check]:
    """The identities, with the volumes of `hollows` [mm3]."""
    if "cavity" in hollow_mm3:
        growth = design.dimensions.shrinkage**3
        skin, whole = parts["skin"].volume_mm3, hollow_mm3["cavity"]
        expected = growth * skin
        if design.mold.method == "overmold":  # the bone does not shrink: what it fills of the skin's form is the rest
            expected += (growth - 1.0) * (whole / growth - skin)
        defect = abs(whole - hollow_mm3["core_in_cavity"] - expected)
        yield Check("step.cavity_less_core_is_skin", defect, RELATIVE * whole, "mm3")
    if "openings" in hollow_mm3:
        m, outline = lay_out(design, design.dimensions), mold.block(design)
        assert isinstance(outline, Box)
        block = math.prod(high - low for low, high in zip(outline.low, outline.high, strict=True))
        filled = hollow_mm3["openings"] + _cuts_mm3(design, m) + sum(parts[half].volume_mm3 for half in HALVES)
        filled += sum(map(_below_parting, mold.keys(design, m, design.mold.key_clearance_mm)))
        filled -= sum(map(_below_parting, mold.keys(design, m)))
        yield Check("step.halves_and_hollows_are_block", abs(block - filled), RELATIVE * block, "mm3")


def _cuts_mm3(design: Design, m: MoldLayout) -> float:
    """Bolts, nut traps, pry slots and letters in closed form: exact, and forty booleans less."""
    d = design.mold
    bolt = math.pi * (d.bolt_diameter_mm / 2) ** 2
    fastened = (
        bolt * (m.palmar_height + m.dorsal_height) + (math.sqrt(0.75) * d.nut_width_mm**2 - bolt) * d.nut_depth_mm
    )
    pried = d.pry_width_mm * d.pry_depth_mm * 2.0 * d.pry_height_mm
    letters = (prism for half in ("palmar", "dorsal") for prism in mold.engraving(design, m, half))
    return len(m.bolts) * fastened + 2.0 * pried + d.engraving_depth_mm * sum(map(_area, letters))


def _area(prism: Solid) -> float:
    """Area [mm2] of a prism's end; its holes run the other way round."""
    assert isinstance(prism, Prism)
    edges = (pair for ring in (prism.corners, *prism.holes) for pair in pairwise([*ring, ring[0]]))
    return sum(a[0] * b[1] - b[0] * a[1] for a, b in edges) / 2.0


def _below_parting(key: Solid) -> float:
    """Volume [mm3] of a key's frustum below the parting plane."""
    assert isinstance(key, Cone)
    top, height = key.low_radius, -key.low
    root = top + (key.high_radius - top) * height / (key.high - key.low)
    return math.pi * height / 3.0 * (top * top + top * root + root * root)
