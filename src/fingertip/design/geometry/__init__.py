"""Geometry derived from the parameters, and the tables of a design with it: every length that parts
and rules share.

In: parameters within their own bounds, not yet checked by the rules. Out: lengths [mm], outlines
and solids.

>>> from fingertip.design.geometry import DesignTables
>>> changes = {"skin.length_mm": 40.0, "sensor.distance_from_tip_mm": 12.0}
>>> DesignTables().with_values(changes).dimensions.sensor_z
28.0
"""

from __future__ import annotations

from collections.abc import Mapping
from functools import cached_property
from pathlib import Path
from typing import TYPE_CHECKING, Any, Self

from fingertip.catalogues.electronics import SENSORS, ForceSensor
from fingertip.design.geometry.casting_layout import CastingLayout
from fingertip.design.geometry.letters import outline_letters
from fingertip.design.geometry.sections import sensor_rim_margin
from fingertip.design.parameters import ELECTRONIC_TABLES, Tables
from fingertip.models.dimensions import Dimensions
from fingertip.models.engraving import Letter

if TYPE_CHECKING:
    from fingertip.foundation.body_file import Body


class DesignTables(Tables):
    @cached_property
    def dimensions(self) -> Dimensions:
        return Dimensions(self)

    @cached_property
    def mold_layout(self) -> CastingLayout:
        return CastingLayout(self, self.dimensions)

    @cached_property
    def sensor_rim_margin(self) -> float:
        """Least margin [mm] along x between the flat's edge and the rim around the sensor."""
        return sensor_rim_margin(self, self.dimensions)

    @property
    def force_sensor(self) -> ForceSensor:
        """Outline of the force-sensing resistor, from the catalogue or from [custom_sensor]."""
        if self.sensor.model != "custom":
            return SENSORS[self.sensor.model]

        own = self.custom_sensor
        return ForceSensor(
            model="custom",
            label="custom sensor",
            active_diameter_mm=own.active_diameter_mm,
            head_diameter_mm=own.head_diameter_mm,
            thickness_mm=own.thickness_mm,
            length_mm=own.length_mm,
            tail_width_mm=own.tail_width_mm,
            tab_pitch_mm=2.54,
            source="the design file",
            unverified=(),
        )

    @property
    def layer_strength_mpa(self) -> float:
        """Tensile strength of the bone's material across its layers [MPa]."""
        return self.strength.material.strength_mpa

    @property
    def letters(self) -> Mapping[str, Letter]:
        """Outlines of the letters that are engraved into the mold."""
        return outline_letters()

    def read_adapter(self) -> Body:
        """Read the file of the adapter. Raises InputFileError or MissingLibraryError."""
        from fingertip.foundation.body_file import read_body  # needs numpy  # noqa: PLC0415

        return read_body(Path(self.bone.adapter_file))

    def model_copy(self, *, update: Mapping[str, Any] | None = None, deep: bool = False) -> Self:
        """Copy the tables with changes.

        What is derived is kept only if no table that it depends on changes.
        """
        copy = super().model_copy(update=update, deep=deep)
        if not ELECTRONIC_TABLES.issuperset(update or ()):
            for name in ("dimensions", "mold_layout", "sensor_rim_margin"):
                copy.__dict__.pop(name, None)

        return copy
