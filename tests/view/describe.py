"""Description of a picture or a scene as text: what is drawn where, in pixels or mm."""

from __future__ import annotations

import io
from collections.abc import Iterable, Iterator
from typing import Any

import numpy as np
import pytest
from PIL import Image, ImageDraw

from tests.figures import sum_up


class PenRecord:
    """What the pens of pictures draw [pixels]."""

    def __init__(self, patch: pytest.MonkeyPatch) -> None:
        self.lines: list[str] = []
        for name in ("line", "polygon", "ellipse", "rectangle", "text", "multiline_text"):
            patch.setattr(ImageDraw.ImageDraw, name, self._recorder(name))

    def _recorder(self, name: str) -> Any:
        def record(pen: Any, at: Any, text: str = "", **named: Any) -> None:
            font = named.pop("font", None)
            look = " ".join(f"{key}={value}" for key, value in sorted(named.items()))
            said = f"{text!r} {font.size:g} px" if font else ""
            self.lines.append(f"{name} {said} {_sum_up_points(at)} {look}")

        return record


def _sum_up_points(points: Any) -> str:
    flat = np.asarray(points, dtype=float).reshape(-1, 2)
    if len(flat) <= 4:
        return sum_up(flat)
    length = np.linalg.norm(np.diff(flat, axis=0), axis=1).sum()
    return f"from {sum_up(flat.min(axis=0))} to {sum_up(flat.max(axis=0))}, long {length:.4g}"


def describe_pixels(picture: bytes, columns: int = 8, rows: int = 12) -> Iterator[str]:
    """Mean colours of the cells of a picture: where it shows what, how bright, and from which side."""
    pixels = np.asarray(Image.open(io.BytesIO(picture)).convert("RGB"), dtype=float)
    for row in np.array_split(pixels, rows):
        yield "cells " + " | ".join(sum_up(cell.mean(axis=(0, 1))) for cell in np.array_split(row, columns, axis=1))


def describe_scene(scene: Any) -> Iterator[str]:
    """Camera, colours and sizes of the bodies, labels, slopes and arrows of a scene [mm]."""
    yield f"  seen from {sum_up(scene.camera.axes[2])}, right {sum_up(scene.camera.axes[0])}"
    for item in scene.shown:
        corners = item.mesh.vertices if len(item.mesh.vertices) else np.zeros((1, 3))  # cut away as a whole
        ends = f"from {sum_up(corners.min(axis=0))} to {sum_up(corners.max(axis=0))}"
        yield f"  body {sum_up(item.colour)} {ends}, {item.mesh.volume():.4g} mm3"
    yield from (f"  label {label.text!r} {sum_up(label.point_mm)}" for label in scene.labels)
    slopes = ((slope.corner_mm, slope.edge_mm, slope.up) for slope in scene.slopes)
    yield from (f"  slope from {sum_up(corner)} by {sum_up(edge)}, up {sum_up(up)}" for corner, edge, up in slopes)
    yield from (f"  arrow {sum_up(arrow.start_mm)} to {sum_up(arrow.end_mm)}" for arrow in scene.arrows)


def join_lines(parts: Iterable[tuple[str, Iterable[str]]]) -> Iterator[str]:
    """Descriptions below their names."""
    for name, lines in parts:
        yield name
        yield from lines
