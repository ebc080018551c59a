"""Grids of simple cavities, whose filling is known in closed form."""

from collections.abc import Callable

import numpy as np

from fingertip.filling.surface_links import Layer, link_layer
from fingertip.foundation.numerics import Array


def slot(rows: int, columns: int, length: float, width: float, thickness: Callable[[Array], Array]) -> Layer:
    """Plane slot from y = 0 to `length`, between z = 0 and the thickness at y [mm]."""
    y, x = np.meshgrid(
        length * np.arange(2 * rows + 1) / (2 * rows), width * np.arange(2 * columns + 1) / (2 * columns), indexing="ij"
    )
    inner = np.stack((x, y, np.zeros_like(x)), axis=2)
    return link_layer(inner, np.stack((x, y, thickness(y)), axis=2), has_pole=False, is_periodic=False)


def disc(rows: int, columns: int, radius: float, thickness: float) -> Layer:
    """Disc whose centre is the pole."""
    r = radius * (1.0 - np.arange(2 * rows + 1) / (2 * rows))
    phi = np.pi * np.arange(2 * columns) / columns
    x, y = r[:, None] * np.cos(phi), r[:, None] * np.sin(phi)
    inner = np.stack((x, y, np.zeros_like(x)), axis=2)
    return link_layer(inner, inner + np.array([0.0, 0.0, thickness]), has_pole=True, is_periodic=True)


def sleeve(rows: int, columns: int, length: float, radii: tuple[float, float]) -> Layer:
    """Gap between two coaxial cylinders."""
    z = length * np.arange(2 * rows + 1) / (2 * rows)
    phi = np.pi * np.arange(2 * columns) / columns
    surfaces = [np.stack(np.broadcast_arrays(r * np.cos(phi), r * np.sin(phi), z[:, None]), axis=2) for r in radii]
    return link_layer(*surfaces, has_pole=False, is_periodic=True)
