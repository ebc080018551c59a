"""Ways of the silicone into the mold and of the air out of it: inlet, or gate and funnel, and vents."""

from __future__ import annotations

from fingertip.cad.solids import Cone, Prism, Solid, cylinder, union
from fingertip.design import Design
from fingertip.design.geometry.mold_layout import Inlet
from fingertip.syringes import LUER_DEPTH_MM, LUER_MOUTH_MM, LUER_TAPER

_SPRUE_DRAFT = 0.03
"""Draft of the sprue, which widens towards the parting plane, so that it lifts out: radius per length."""


def runners(design: Design) -> tuple[Solid, ...]:
    """Build everything that silicone and air flow through outside the cavity, but for the Luer cone."""
    inlet = design.mold_layout.inlet
    if inlet:
        return sprue(design, inlet), runner(inlet), *vents(design)
    return (*gate_and_funnel(design), *vents(design))


def luer_cone(design: Design) -> tuple[Solid, ...]:
    """Build the cone in the dorsal half on which the syringe sits; none if gravity fills the mold.

    It widens towards the outside, which a casting cannot leave: the nozzle fills most of it.
    """
    inlet, layout = design.mold_layout.inlet, design.mold_layout
    if inlet is None:
        return ()
    mouth, face = LUER_MOUTH_MM / 2, layout.dorsal_height
    slope, low = LUER_TAPER / 2, layout.dorsal_height - LUER_DEPTH_MM
    # It continues past the face at the same taper, so that its mouth has the stated diameter there.
    end = face + LUER_DEPTH_MM
    return (Cone("y", (inlet.z, inlet.x), low, end, mouth - slope * LUER_DEPTH_MM, mouth + slope * (end - face)),)


def sprue(design: Design, inlet: Inlet) -> Solid:
    """Build the sprue from the end of the Luer cone to the parting plane."""
    radius = (LUER_MOUTH_MM - LUER_TAPER * LUER_DEPTH_MM) / 2
    top = design.mold_layout.dorsal_height - LUER_DEPTH_MM
    # It reaches into the cone by a length that leaves no coincident face.
    overlap = LUER_DEPTH_MM / 10
    low = radius + _SPRUE_DRAFT * top
    return Cone("y", (inlet.z, inlet.x), 0.0, top + overlap, low, radius - _SPRUE_DRAFT * overlap)


def runner(inlet: Inlet) -> Solid:
    """Build the runner from the sprue into the cavity: along z in the column of the bolts, then along x."""
    half, x, z = inlet.width / 2, inlet.x, inlet.gate_z
    corners = (
        (inlet.z, x - half), (z + half, x - half), (z + half, inlet.gate_x), (z - half, inlet.gate_x),
        (z - half, x + half), (inlet.z, x + half),
    )  # fmt: skip
    return Prism("y", corners[::-1], 0.0, inlet.depth)


def gate_and_funnel(design: Design) -> tuple[Solid, ...]:
    """Build the gate and its funnel on the parting plane of a mold that gravity fills."""
    mold, m = design.mold, design.mold_layout
    end = m.distal_z + mold.funnel_depth_mm
    gate = cylinder("z", (m.gate_x, 0.0), m.inlet_z, end, mold.gate_diameter_mm / 2)
    # The funnel continues past the block at the same slope, so that its mouth has the stated diameter on the block's
    # face.
    mouth, throat = mold.funnel_diameter_mm / 2, mold.gate_diameter_mm / 2
    funnel = Cone("z", (m.gate_x, 0.0), m.distal_z - mold.funnel_depth_mm, end, throat, mouth + (mouth - throat))
    return gate, funnel


def vents(design: Design) -> tuple[Solid, ...]:
    """Build the vents."""
    m, solids = design.mold_layout, []
    for vent in m.vents:
        x, y, z = vent.point_mm
        radius = vent.diameter_mm / 2
        if vent.axis == "z":
            solids.append(cylinder("z", (x, y), z, m.distal_z + design.mold.funnel_depth_mm, radius))
        else:
            solids.append(cylinder("y", (z, x), y, 2 * m.dorsal_height, radius))
    return tuple(solids)


def openings(design: Design) -> Solid:
    """Build all of it as one solid."""
    return union(*runners(design), *luer_cone(design))


def runners_with_axes(design: Design) -> tuple[tuple[Solid, int], ...]:
    """List these solids with the axis along which each opens to the outside or the parting plane: 1 for y, 2 for z."""
    in_layout = tuple({"y": 1, "z": 2}[vent.axis] for vent in design.mold_layout.vents)
    beside = tuple(zip(vents(design), in_layout, strict=True))
    inlet = design.mold_layout.inlet
    if inlet:
        return (sprue(design, inlet), 1), (runner(inlet), 1), *((cone, 1) for cone in luer_cone(design)), *beside
    return (*((solid, 2) for solid in gate_and_funnel(design)), *beside)
