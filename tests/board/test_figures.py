"""Figures with a few significant digits."""

from __future__ import annotations

import pytest

from fingertip.board.analysis.figures import format_figure


@pytest.mark.parametrize(
    ("value", "digits", "text"),
    [
        (67.2503, 4, "67.25"), (44493.6, 4, "44490"), (0.98952, 4, "0.9895"), (9999.96, 4, "10000"), (0.0, 4, "0"),
        (-0.0, 4, "0"), (-3.14159, 3, "-3.14"), (0.000123456, 2, "0.00012"), (8854.0, 2, "8900"),
    ],
)  # fmt: skip
def test_figures_have_the_given_number_of_significant_digits(value: float, digits: int, text: str) -> None:
    assert format_figure(value, digits) == text
