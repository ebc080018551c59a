"""Verification of built parts: file topology, identities between parts, clearances and wall thicknesses.

`verify.verify` runs every check of a design. `bone`, `skin` and `mold` measure the parts that `cad.shapes` builds.

Limits come from the design. Where facets are measured, a limit is relaxed by the mesh tolerance:

- `bone.wall.*` and `mold.wall.*`: printer.min_wall_mm less the tolerance;
- `bone.wall.sensor_to_outside`: 95% of bone.rim_mm or, if less, of the wall limit;
- `sensor.pocket_clearance`: the smaller of sensor.clearance_mm and sensor.adhesive_thickness_mm, less the tolerance;
- `skin.min_thickness*`: skin.min_thickness_mm less the tolerance;
- `skin.fitting_stretch`: mold.max_stretch_percent;
- `*.recess_clearance`: 75% of mold.fit_clearance_mm less the tolerance;
- `mold.land.*`: mold.land_mm less the clearance of the keys on both sides;
- `*.draft_clearance_gain.*`: the gain at mold.draft_deg less the tolerance;
- `*.build_volume_excess`: 0, relative to printer.bed_x_mm, bed_y_mm and bed_z_mm;
- `*.overhang`: the corner of a ledge that prints over air (`cad.printing.overhang`), outside the places of supports;
- `plate_*.gap`: the distance of parts on a plate, for the process;
- `*.genus`: the number of through holes that the design has.
"""
