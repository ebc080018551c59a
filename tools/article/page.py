"""Page of the manual: what this project finds beside the article, and under other laws.

The data stand in `tools/article/beside_article.json`, which the page of the studies quotes too.
"""

from __future__ import annotations

import json
import math
from collections.abc import Mapping
from dataclasses import asdict
from pathlib import Path
from typing import Any

from fingertip.design import Design
from fingertip.documents.template import WIDTH, lay_out_page, render_text
from fingertip.foundation.jit import compiled
from fingertip.lab.campaign.run import measure_vibration_n
from fingertip.lab.divider import with_variant
from fingertip.sim import run_scene
from fingertip.sim.contact.materials import ARTICLE_SURFACES, SURFACES
from fingertip.sim.signal.converter import simulate_quiescent_level
from tools.article.boards import VARIANTS
from tools.article.previous_works import study_previous_works
from tools.article.protocol import study_article_protocol
from tools.article.protocol_table import PROTOCOL_COLUMNS, list_protocol_rows
from tools.article.robustness import variations_as_data
from tools.article.sensitivity import (
    LOADED_ON,
    LOADS_N,
    PATCH_AVERAGE,
    VARIATIONS,
    measure_envelope_v,
    slide_at,
    study_assumptions,
)
from tools.article.studies import DATA

PAGE = Path(__file__).resolve().parents[2] / "docs/beside_article.md"
TEMPLATE = Path(__file__).with_name("beside_article.md")
FORCES_N = (0.3, 0.5, 0.8, 1.2, 2.0)
SEEDS = range(10)
DESIGNS, DETECTORS = ("article", "fsr400"), ("digital", "fast")


def measure_contact_n(design: Design, surface: str) -> float:
    """Measure the RMS vibration of the contact force in slip at 1 N and 6 cm/s, before sensor, board and noise [N]."""
    scene = slide_at(surface, 1.0).model_copy(update={"outputs": ["voltage_v", "force_n", "slip"]})
    with compiled():
        squares = [measure_vibration_n(run_scene(design, scene, seed).trace) ** 2 for seed in SEEDS]
    return math.sqrt(sum(squares) / len(squares))


def measure_board(design: Design) -> dict[str, Any]:
    """Measure the mean envelope by surface and force, and the force from which it exceeds what the noise allows [N]."""
    threshold_v = simulate_quiescent_level(design).rounded_threshold_v
    envelopes_v = {
        name: [measure_envelope_v(design, name, force_n, SEEDS) for force_n in FORCES_N] for name in ARTICLE_SURFACES
    }
    above_n = {
        name: [force_n for force_n, volts in zip(FORCES_N, row, strict=True) if volts > threshold_v]
        for name, row in envelopes_v.items()
    }
    return {
        "threshold_mv": 1000 * threshold_v,
        "envelopes_mv": {name: [round(1000 * volts, 3) for volts in row] for name, row in envelopes_v.items()},
        "above_noise_n": above_n,
    }


def measure() -> dict[str, Any]:
    """Measure everything, as the data of the page."""
    article = Design.load("article")
    rows = list_protocol_rows(study_article_protocol(article), study_previous_works(article))
    variations = [one for one in VARIATIONS if one.is_law or one.label == PATCH_AVERAGE]
    return {
        "devices": list(PROTOCOL_COLUMNS),
        "protocol": list(map(asdict, rows)),
        "contact_mn": {name: round(1000 * measure_contact_n(article, name), 2) for name in ARTICLE_SURFACES},
        "roughness_um": {name: SURFACES[name].roughness_um for name in ARTICLE_SURFACES},
        "forces_n": FORCES_N,
        "boards": {variant: measure_board(with_variant(article, variant)) for variant in VARIANTS},
        "loads_n": LOADS_N,
        "loaded_on": LOADED_ON,
        "laws": {
            f"{detector}, {name}": variations_as_data(
                study_assumptions(Design.load(name), detector, variations=variations)
            )
            for name in DESIGNS
            for detector in DETECTORS
        },
    }


def render_page(data: Mapping[str, Any]) -> str:
    """Write the page from the data."""
    return lay_out_page(render_text(TEMPLATE.read_text(encoding="utf-8"), **data), WIDTH)


def write_page() -> None:
    """Measure, and write both files."""
    data = json.loads(json.dumps(measure(), allow_nan=False))
    DATA.write_text(json.dumps(data, indent=1) + "\n", encoding="utf-8")
    PAGE.write_text(render_page(data), encoding="utf-8")
