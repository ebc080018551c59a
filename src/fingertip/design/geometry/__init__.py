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
from typing import Any, Self

from fingertip.design.geometry.dimensions import Dimensions
from fingertip.design.geometry.mold_layout import MoldLayout
from fingertip.design.parameters import ELECTRONIC_TABLES, Tables


class DesignTables(Tables):
    @cached_property
    def dimensions(self) -> Dimensions:
        return Dimensions(self)

    @cached_property
    def mold_layout(self) -> MoldLayout:
        return MoldLayout(self, self.dimensions)

    def model_copy(self, *, update: Mapping[str, Any] | None = None, deep: bool = False) -> Self:
        """Copy the tables with changes.

        What is derived is kept only if no table that it depends on changes.
        """
        copy = super().model_copy(update=update, deep=deep)
        if not ELECTRONIC_TABLES.issuperset(update or ()):
            for name in ("dimensions", "mold_layout"):
                copy.__dict__.pop(name, None)

        return copy
