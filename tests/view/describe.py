"""Description of a picture as text: what is drawn where, in pixels."""

from __future__ import annotations

import io
from collections.abc import Iterator
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
            look = " ".join(f"{key}={str(value)!r}" for key, value in sorted(named.items()))
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
    """Mean colours of the cells of a picture: where it shows what, how bright, and from
    which side.
    """
    pixels = np.asarray(Image.open(io.BytesIO(picture)).convert("RGB"), dtype=float)
    for row in np.array_split(pixels, rows):
        yield "cells " + " | ".join(
            sum_up(cell.mean(axis=(0, 1))) for cell in np.array_split(row, columns, axis=1)
        )
