"""Style of the plots: colours that differ in grey and for colour-blind readers."""

from __future__ import annotations

import itertools

import numpy as np
import pytest

from fingertip.foundation.display import AREAS, SERIES, TRUTH, new_figure, to_png
from fingertip.lab.report.plots import COLOURS, OTHER_COLOUR

XYZ = np.array(
    [
        [0.4124564, 0.3575761, 0.1804375],
        [0.2126729, 0.7151522, 0.0721750],
        [0.0193339, 0.1191920, 0.9503041],
    ]
)
"""Linear sRGB to CIE XYZ, IEC 61966-2-1."""
VISION = {
    "usual": np.eye(3),
    "no red cones": np.array(
        [
            [0.152286, 1.052583, -0.204868],
            [0.114503, 0.786281, 0.099216],
            [-0.003882, -0.048116, 1.051998],
        ]
    ),
    "no green cones": np.array(
        [
            [0.367322, 0.860646, -0.227968],
            [0.280085, 0.672501, 0.047413],
            [-0.011820, 0.042940, 0.968881],
        ]
    ),
}
"""Linear sRGB as seen:
G. M. Machado et al., IEEE Trans. Vis. Comput. Graph. 15 (2009) 1291, severity 1.
"""


def to_linear(colour: str) -> np.ndarray:
    encoded = np.array([int(colour[i : i + 2], 16) / 255 for i in (1, 3, 5)])
    return np.where(encoded <= 0.04045, encoded / 12.92, ((encoded + 0.055) / 1.055) ** 2.4)


def to_lab(linear: np.ndarray) -> np.ndarray:
    """CIELAB under D65: lightness, green to red, blue to yellow."""
    ratio = XYZ @ linear / np.array([0.95047, 1.0, 1.08883])
    f = np.where(
        ratio > 216 / 24389, np.cbrt(np.clip(ratio, 0, None)), (24389 / 27 * ratio + 16) / 116
    )
    return np.array([116 * f[1] - 16, 500 * (f[0] - f[1]), 200 * (f[1] - f[2])])


def lightness(colour: str) -> float:
    return float(to_lab(to_linear(colour))[0])


def test_colours_of_curves_differ_for_everybody() -> None:
    assert lightness("#777777") == pytest.approx(50.0, abs=0.2)
    for one, other in itertools.combinations((*SERIES, TRUTH), 2):
        assert abs(lightness(one) - lightness(other)) >= 8.0, "the same in grey"
        for name, seen in VISION.items():
            apart = [to_lab(np.clip(seen @ to_linear(colour), 0, 1)) for colour in (one, other)]
            assert np.linalg.norm(apart[0] - apart[1]) >= 15.0, (one, other, name)
    for colour in SERIES:  # contrast of graphics by WCAG 2.1, criterion 1.4.11
        assert 1.05 / ((XYZ @ to_linear(colour))[1] + 0.05) >= 3.0
    for one, other in itertools.pairwise(AREAS):
        assert abs(lightness(one) - lightness(other)) >= 15.0
    assert set(COLOURS.values()) | {OTHER_COLOUR} == set(SERIES)
    # A threshold of fast.
    own = {name: colour for name, colour in COLOURS.items() if name != "incipient"}
    assert len(own) + 1 == len(SERIES), "each detector has a colour of its own"


def test_a_name_is_no_formula_and_the_ticks_of_a_logarithmic_axis_are() -> None:
    pytest.importorskip("matplotlib")
    figure = new_figure(2.0, 2.0)
    axes = figure.subplots()
    axes.set_xscale("log")
    axes.set_title(r"$\nosuch$.csv")
    assert to_png(figure).startswith(b"\x89PNG")
    assert axes.title.get_parse_math() is False
    assert all(label.get_parse_math() for label in axes.get_xticklabels())
