"""Picture of a design as an object, for Python and Jupyter."""

from __future__ import annotations

from fingertip.design import Design
from fingertip.display import Picture
from fingertip.view.picture import draw


def picture(design: Design, width_px: int = 1600) -> Picture:
    """Draw a design: exploded views, a section through the closed mold and, with a joint, the finger on its hand.

    Parameters
    ----------
    design
        The fingertip.
    width_px
        Width of the picture [pixels].
    """
    return Picture(draw(design, width_px))
