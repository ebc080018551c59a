"""Pictures of what each parameter changes, drawn on the part that it changes most.

Nobody drew these pictures: the parameter is changed, the parts are made again, and what is seen nearer or farther than
before is coloured. A parameter that a design does not use is shown on another design that does.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from contextlib import suppress
from dataclasses import dataclass
from functools import lru_cache
from typing import Any

import numpy as np
from numpy.typing import NDArray
from PIL import Image, ImageDraw

from fingertip.cad.kernel.mesh import Mesh, MeshEvaluator, to_canonical_mesh
from fingertip.cad.shapes.parts import parts_by_name, shapes_of_parameters
from fingertip.design import Design
from fingertip.design.files import format_value
from fingertip.design.geometry.solids import Solid
from fingertip.design.parameters import PARAMETERS
from fingertip.design.parameters.declaration import find_bounds, find_unit, format_unit, list_choices
from fingertip.foundation.errors import DesignError, FingertipError
from fingertip.foundation.numerics import Array
from fingertip.pictures.raster import Camera, Canvas, bounds, to_png

_TOLERANCE_MM = 0.04
_SEEN_MM = 0.1
"""Change of depth that is coloured, larger than what two tessellations of one surface differ by [mm]."""
_WIDTH_PX, _HEIGHT_PX, _MARGIN_PX = 420, 280, 14
_SMALL_SHARE, _LEAST_RING_PX, _LARGEST_RING_PX = 0.012, 16.0, 60.0
_RING = (120, 20, 70)
_COLOURS = 96
_FACTOR = 1.3
"""Factor by which a number is changed."""
_SHARES = (1.0, -1.0, 0.5, -0.5, 0.25, -0.25, 0.1, -0.1)
"""Shares of that change, the first that gives a design in which something is seen being taken."""
_LEAST_SEEN_PX = 40
"""Number of changed pixels below which nothing is seen: two tessellations of one surface differ by as many."""
_LEAST_CHANGE = 0.3
"""Least first change of a number, so that small ones are seen; in its unit."""
_GREY, _NEARER, _FARTHER = (0.90, 0.89, 0.87), (0.90, 0.52, 0.10), (0.22, 0.47, 0.80)
_VIEWS = {
    "from the back": Camera.from_angles(28, 24),
    "from the palm": Camera.from_angles(28, -38),
    "cut lengthwise": Camera.from_angles(0, 0),
}
_ELSEWHERE = (
    ("fsr400", ("bone.interface=socket",)), ("fsr400", ("bone.interface=flange",)),
    ("fsr400", ("sensor.model=custom",)), ("adult_finger", ()), ("child_finger", ()), ("adult_thumb", ()),
)  # fmt: skip
"""Bundled designs and changes that use the parameters which another design may not use."""


@dataclass(frozen=True)
class AtlasPicture:
    path: str
    part: str
    view: str
    before: Any
    after: Any
    drawn_on: str
    """Name of the design that it is drawn on, with its changes; "" for the design of the atlas."""
    png: bytes

    @property
    def caption(self) -> str:
        unit = format_unit(find_unit(PARAMETERS[self.path]))
        change = f"{format_value(self.before)} to {format_value(self.after)}{unit}"
        where = f"; drawn on {self.drawn_on}" if self.drawn_on else ""
        return f"{self.part.replace('_', ' ')}, {self.view}: from {change}{where}"


def draw_atlas(design: Design, progress: Callable[[str], None] = lambda message: None) -> Iterator[AtlasPicture]:
    """Draw a picture for each parameter that shapes a part, in the order of a design file."""
    bases = [("", design)]
    for name, changes in _ELSEWHERE:
        with suppress(DesignError):  # a change that a bundled design no longer takes: its parameters have no picture
            bases.append((" with ".join((name, *changes)), Design.load(name, changes=changes)))
    used = [(label, base, shapes_of_parameters(base)) for label, base in bases]
    for path in PARAMETERS:
        for label, base, parts in used:
            if path in parts and (picture := draw_parameter(base, path, parts[path], label)):
                progress(f"{path}: {picture.part}, {picture.view}")
                yield picture
                break


def draw_parameter(design: Design, path: str, parts: tuple[str, ...], drawn_on: str = "") -> AtlasPicture | None:
    """Draw what a change of one parameter does to the part that it changes most; None if nothing is seen."""
    for changed in list_changes(design, path):
        with suppress(FingertipError):  # another change may make parts
            if found := _draw_change(design, changed, parts):
                part, view, png = found
                return AtlasPicture(path, part, view, design.value(path), changed.value(path), drawn_on, png)
    return None


def list_changes(design: Design, path: str) -> Iterator[Design]:
    """Yield designs in which one parameter is changed, and the others stay as they are: the clearest change first."""
    declared, value = PARAMETERS[path], design.value(path)
    if choices := list_choices(declared):
        wanted: list[Any] = [word for word in choices if word != value]
    elif isinstance(value, int | float):
        bounds = find_bounds(declared)
        first = max(abs(value) * (_FACTOR - 1.0), _LEAST_CHANGE)
        steps = (share * first for share in _SHARES)
        wanted = [round(value + step, 3) for step in steps if bounds.contain(round(value + step, 3))]
    else:
        return
    tables = design.model_dump(mode="json")
    table, _, key = path.rpartition(".")
    for other in wanted:
        new = {**tables, table: {**tables[table], key: other}} if table else {**tables, key: other}
        with suppress(DesignError):
            yield Design.without_remedies(**new)


def _draw_change(before: Design, after: Design, parts: tuple[str, ...]) -> tuple[str, str, bytes] | None:
    shares = {part: _measure_change(before, after, part) for part in parts}
    part = max(shares, key=lambda name: shares[name])
    if not shares[part]:
        return None
    seen = {view: _compare(before, after, part, view) for view in _VIEWS}
    view = max(seen, key=lambda name: seen[name][0])
    count, picture = seen[view]
    return (part, view, picture()) if count >= _LEAST_SEEN_PX else None


def _measure_change(before: Design, after: Design, part: str) -> float:
    """Measure the volume that a part gains and loses, over its own."""
    old, new = (_solid(design, part) for design in (before, after))
    if old == new or new is None or old is None:
        return 0.0
    first, second = _EVALUATOR.manifold(old), MeshEvaluator(_TOLERANCE_MM).manifold(new)
    changed = float((first - second).volume() + (second - first).volume())
    return changed / float(first.volume())


_EVALUATOR = MeshEvaluator(_TOLERANCE_MM)


def _solid(design: Design, part: str) -> Solid | None:
    found = parts_by_name(design).get(part)
    return found.solid(design) if found else None


@lru_cache(maxsize=64)
def _mesh(solid: Solid, is_cut: bool) -> Mesh:
    """Make the mesh of a part, or of its half behind the plane x = 0."""
    manifold = MeshEvaluator(_TOLERANCE_MM).manifold(solid)
    return to_canonical_mesh(manifold.trim_by_plane((1.0, 0.0, 0.0), 0.0) if is_cut else manifold)


def _compare(before: Design, after: Design, part: str, view: str) -> tuple[int, Callable[[], bytes]]:
    """Compare a part in one view; returns the number of pixels that changed, and a function that makes the picture."""
    camera, is_cut = _VIEWS[view], view.startswith("cut")
    solids = [_solid(design, part) for design in (before, after)]
    meshes = [_mesh(solid, is_cut) for solid in solids if solid is not None]
    centre, size = bounds(meshes, camera)
    scale = min((_WIDTH_PX - 2 * _MARGIN_PX) / size[0], (_HEIGHT_PX - 2 * _MARGIN_PX) / size[1])
    old, new = (Canvas(_WIDTH_PX, _HEIGHT_PX, scale, camera) for _ in meshes)
    for canvas, mesh in zip((old, new), meshes, strict=True):
        canvas.draw(mesh, _GREY, centre)
    nearer, farther = find_depth_changes(old.depth_mm, new.depth_mm, _SEEN_MM)
    return int(nearer.sum() + farther.sum()), lambda: _paint(new, nearer, farther)


def find_depth_changes(old: Array, new: Array, least: float) -> tuple[NDArray[np.bool_], NDArray[np.bool_]]:
    """Find the pixels that are nearer to the viewer than before, and those that are farther, by more than `least`.

    The depth grows towards the viewer; it is minus infinity where nothing is.
    """
    with np.errstate(invalid="ignore"):
        change = np.where(np.isinf(old) & np.isinf(new), 0.0, new - old)
    return change > least, change < -least


def _paint(canvas: Canvas, nearer: NDArray[np.bool_], farther: NDArray[np.bool_]) -> bytes:
    """Paint what changed, with a ring around it where it is small, and write the picture as PNG with few colours."""
    for mask, colour in ((nearer, _NEARER), (farther, _FARTHER)):
        canvas.tint(mask, colour)
    picture = Image.fromarray(canvas.image())
    if ring := find_ring(nearer | farther, picture.height):
        ImageDraw.Draw(picture).ellipse(ring, outline=_RING, width=2)
    rows = np.flatnonzero((np.asarray(picture) < 255).any(axis=(1, 2)))
    picture = picture.crop((0, max(0, rows[0] - _MARGIN_PX), picture.width, rows[-1] + _MARGIN_PX))
    picture = picture.quantize(_COLOURS, method=Image.Quantize.MAXCOVERAGE, dither=Image.Dither.NONE)
    return to_png(picture)


def find_ring(changed: NDArray[np.bool_], height_px: int) -> tuple[float, float, float, float] | None:
    """Find the ring around a small change: left, top, right, bottom [pixels]; None around a large one."""
    rows, columns = np.nonzero(changed)
    fine = changed.shape[0] / height_px
    if not len(rows) or len(rows) > _SMALL_SHARE * changed.size:
        return None
    middle = np.array([columns.mean(), rows.mean()]) / fine
    away = np.hypot(columns / fine - middle[0], rows / fine - middle[1])
    radius = max(_LEAST_RING_PX, float(np.quantile(away, 0.95)) + 6.0)
    if radius > _LARGEST_RING_PX:  # small, but in several places
        return None
    return middle[0] - radius, middle[1] - radius, middle[0] + radius, middle[1] + radius
