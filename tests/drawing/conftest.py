"""Sheets of bundled designs, drawn once a session."""

from __future__ import annotations

import pytest

from fingertip.design import Design
from fingertip.pictures.drawing.draw import run_apart, sheet_jobs
from fingertip.pictures.drawing.primitives import Sheet
from tests.conftest import ROOT, design_file, some_of

FILES = sorted(path.stem for path in (ROOT / "params").glob("*.toml"))
CALIBRATED = ("printer.offset_mm=0.08", "printer.scale_percent=100.4")
VARIANTS = some_of(
    [*((name, ()) for name in FILES), ("adult_finger", CALIBRATED)], ("adult_finger", CALIBRATED)
)


def load_variant(variant: tuple[str, tuple[str, ...]]) -> Design:
    name, changes = variant
    return Design.load(design_file(name), changes=changes)


@pytest.fixture(
    scope="session", params=VARIANTS, ids=lambda variant: "-".join((variant[0], *variant[1]))
)
def drawn(request: pytest.FixtureRequest) -> tuple[Design, dict[str, Sheet]]:
    """Design and its sheets by part."""
    design = load_variant(request.param)
    return design, run_apart(sheet_jobs(design))
