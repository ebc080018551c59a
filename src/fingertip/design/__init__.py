"""Design of a fingertip: parameters, their bounds, the rules between them, and the geometry derived
from them.

In: design files and changes. Out: a frozen `Design`, or a `DesignError`, each message with a remedy
that passes.

>>> from fingertip.design import Design
>>> Design.load("first_finger", changes=["skin.width_mm=19.5"]).changes()["skin.width_mm"]
19.5
"""

from fingertip.design.design import Design

__all__ = ["Design"]
