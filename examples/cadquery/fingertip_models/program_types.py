"""Types of the program, for type checkers alone: where this folder lies beside scripts, nothing
reads them.

A `Finger` has the tables of parameters (`finger.skin.width_mm`), and what follows from them:
`dimensions`, `mold_layout`, `force_sensor`, `layer_strength_mpa` and `letters`. A design of the
program is one, and so is the finger of `parameters.py` beside the scripts.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from fingertip.catalogues.electronics import ForceSensor
    from fingertip.design.geometry import DesignTables as Finger
    from fingertip.foundation.body_file import Body
    from fingertip.foundation.numerics import Array

__all__ = ["Array", "Body", "Finger", "ForceSensor"]
