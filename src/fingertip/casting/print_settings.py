"""Settings of the slicer for the printed parts, for a filament (FDM) and a resin printer (SLA)."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from fingertip.cad.printing.orientations import Orientation
from fingertip.cad.printing.settings import (
    BRIM_MM,
    FIRST_LAYER_MM,
    LAYER_MM,
    NOZZLE_MM,
    RESIN_LAYER_MM,
    WALLS,
    infill_percent,
    needs_brim,
)
from fingertip.casting.uses import join


def print_settings(orientations: Mapping[str, Orientation]) -> dict[str, Any]:
    """Collect the settings for the parts of a design, by process. Parts that stand on end get a brim."""
    upright = [name for name, lies in orientations.items() if needs_brim(lies)]
    lying = [name for name in orientations if name not in upright]
    return {
        "fdm": {
            "nozzle_mm": NOZZLE_MM,
            "layer_mm": LAYER_MM,
            "first_layer_mm": FIRST_LAYER_MM,
            "walls": WALLS,
            "wall_mm": round(WALLS * NOZZLE_MM, 2),
            "infill_percent": {name: infill_percent(name) for name in orientations},
            "brim_mm": BRIM_MM,
            "brim_on": upright,
            "no_brim_on": lying,
        },
        "sla": {"layer_mm": RESIN_LAYER_MM},
        "supports_on": [name for name, lies in orientations.items() if lies.needs_supports],
        "no_supports_on": [name for name, lies in orientations.items() if not lies.needs_supports],
    }


def describe_settings(settings: Mapping[str, Any]) -> list[tuple[str, str, str]]:
    """Describe the settings as rows: what is set, for filament, and for resin."""
    fdm, sla = settings["fdm"], settings["sla"]
    infill = fdm["infill_percent"]
    shares = [
        f"{share} % for {join([name for name in infill if infill[name] == share])}"
        for share in sorted(set(infill.values()), reverse=True)
    ]
    supports = f"yes for {join(settings['supports_on'])}, only where the next table says"
    if settings["no_supports_on"]:
        supports += f"; no for {join(settings['no_supports_on'])}"
    brim = f"yes for {join(fdm['brim_on'])}: {fdm['brim_mm']:g} mm wide, around the outside of the foot, cut off later"
    if fdm["no_brim_on"]:
        brim += f"; no for {join(fdm['no_brim_on'])}"
    return [
        (
            "layer height",
            f"{fdm['layer_mm']:g} mm, the first one {fdm['first_layer_mm']:g} mm, nozzle {fdm['nozzle_mm']:g} mm",
            f"{sla['layer_mm']:g} mm",
        ),
        ("walls", f"{fdm['walls']} lines, {fdm['wall_mm']:g} mm", "solid"),
        ("infill", "; ".join(shares), "solid, not hollowed"),
        ("orientation", "as on the plate: see the next table", "as on the plate: see the next table"),
        ("brim", brim, "no; a raft only under supports"),
        ("supports", supports, supports),
    ]
