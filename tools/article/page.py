"""Page of the manual: what this project finds beside the article, and under other laws.

The data stand in `tools/article/beside_article.json`, which the page of the studies quotes too.
"""

from __future__ import annotations

import json
from collections.abc import Mapping, Sequence
from dataclasses import asdict
from pathlib import Path
from typing import Any

from fingertip.design import Design
from fingertip.documents.template import WIDTH, lay_out_page, render_text
from fingertip.foundation.workers import find_workers, side_by_side
from fingertip.lab.board_comparison import with_variant
from fingertip.sim.contact.surface_files import ARTICLE_SURFACES
from fingertip.sim.signal.converter import simulate_quiescent_level
from tools.article import level
from tools.article.boards import VARIANTS
from tools.article.pictures.collect import draw_figures, render_figures
from tools.article.previous_works import study_previous_works
from tools.article.protocol import study_article_protocol
from tools.article.protocol_table import PROTOCOL_COLUMNS, list_protocol_rows
from tools.article.robustness import variations_as_data
from tools.article.rows import STATES, fill_reason, load_rows
from tools.article.sensitivity import (
    LOADED_ON,
    LOADS_N,
    PATCH_AVERAGE,
    VARIATIONS,
    measure_envelope_v,
    study_assumptions,
)
from tools.article.studies import DATA

PAGE = Path(__file__).resolve().parents[2] / "docs/beside_article.md"
PICTURE = PAGE.with_name("vibration_level.png")
TEMPLATE = Path(__file__).with_name("beside_article.md")
FIGURES = Path(__file__).with_name("figures.json")
"""Titles, captions and statements of the article's figures."""
FORCES_N = (0.3, 0.5, 0.8, 1.2, 2.0)
SEEDS = range(10)
DESIGNS = ("article",)
DETECTORS = ("analog", "fast")


def measure_board(design: Design) -> dict[str, Any]:
    """Measure the mean envelope by surface and force, and the force
    from which it exceeds what the noise allows [N].
    """
    threshold_v = simulate_quiescent_level(design).rounded_threshold_v
    envelopes_v = {
        name: [measure_envelope_v(design, name, force_n, SEEDS) for force_n in FORCES_N]
        for name in ARTICLE_SURFACES
    }
    above_n = {
        name: [force_n for force_n, volts in zip(FORCES_N, row, strict=True) if volts > threshold_v]
        for name, row in envelopes_v.items()
    }

    return {
        "threshold_mv": 1000 * threshold_v,
        "envelopes_mv": {
            name: [round(1000 * volts, 3) for volts in row] for name, row in envelopes_v.items()
        },
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
        "level": {"points": level.as_data(level.search()), "statements": level.STATEMENTS},
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


def render_page(data: Mapping[str, Any], figures: Sequence[Mapping[str, Any]]) -> str:
    """Write the page from its data, and those of the figures."""
    rows = load_rows()
    summary: dict[str, Any] = {
        "level": {**data["level"], "summary": level.summarise(data["level"]["points"])},
        "strength": Design.load("article").strength,
        "states": {state: sum(row.state == state for row in rows) for state in STATES},
        "unmet": [(row, fill_reason(row, data["protocol"])) for row in rows if not row.is_met],
    }
    return lay_out_page(
        render_text(
            TEMPLATE.read_text(encoding="utf-8"),
            **{**data, **summary},
            figures=render_figures(figures),
        ),
        WIDTH,
    )


def write_page() -> None:
    """Measure, and write data, page and pictures."""
    with side_by_side(find_workers(None)):
        data = json.loads(json.dumps(measure(), allow_nan=False))

    PICTURE.write_bytes(level.plot(data["level"]["points"]))
    DATA.write_text(json.dumps(data, indent=1) + "\n", encoding="utf-8")
    write_figures()


def write_figures() -> None:
    """Draw the article's figures, and write them, their data and the page."""
    figures = draw_figures(Design.load("article"))
    for one in figures:
        PAGE.with_name(one.file).write_bytes(one.picture)

    texts = [one.as_data() for one in figures]
    FIGURES.write_text(json.dumps(texts, indent=1) + "\n", encoding="utf-8")
    PAGE.write_text(render_page(json.loads(DATA.read_bytes()), texts), encoding="utf-8")
