"""Level of vibration that the article allows: a search over level, exponent over roughness, and the
board's diode.

Each point is the article's 120 trials on its own finger and board, with the threshold that the
board's noise allows. A level is the roughness that the pad feels where Ra is 1 um; what it feels of
others grows with Ra to the power of the exponent. The amplifiers are ideal here, so that a signal
beyond the range is counted in full.
"""

from __future__ import annotations

import math
import random
from collections.abc import Iterable, Iterator, Mapping
from dataclasses import asdict, dataclass
from functools import partial
from typing import Any

import numpy as np

from benchmarks.board_range import measure_beyond_range
from fingertip.design import Design
from fingertip.foundation import display as style
from fingertip.foundation.workers import call_each
from fingertip.lab.board_comparison import with_variant
from fingertip.lab.campaign.run import TrialResult, evaluate
from fingertip.sim.contact.surface_files import ARTICLE_SURFACES, SURFACES, SurfaceTable
from fingertip.sim.runs.scene import run_scene
from fingertip.sim.signal.analog_circuit import DIODES
from fingertip.sim.signal.converter import simulate_quiescent_level
from fingertip.sim.signal.parameters import Sensing
from tools.article.boards import with_article_board
from tools.article.protocol import pool
from tools.article.steps import generate_trials

LEVELS_UM = (0.7, 2.8)
EXPONENTS = (0.0, 0.8)
"""Ranges of level [um], drawn evenly over its logarithm, and of the exponent."""
POINTS = 48
SEED = 88
"""Points for each diode, and seed of the search."""
BUILT = "1N4148"
FINER_UM = (1.3, 1.8)
FINER_EXPONENTS = (0.0, 0.2)
FINER_POINTS = 24
"""Finer box around the default, for the diode that is built."""
STATEMENTS = {
    "range": "at most 1 % of the samples of a slide leave +3.5 V to -2 V",
    "found": "120 of 120 slips are found",
    "means": "the mean delay on each flat surface is below 60 ms",
    "bin": "the fullest bin is that at 15 ms",
    "spread": "the largest standard deviation of a delay is 15 ms at most",
}
"""Statement of the article, or limit of its board -> words.
Delays count from the encoders' zero.
"""
FIRST = ("range", "found", "means")
"""Statements that the default keeps."""


@dataclass(frozen=True)
class LevelPoint:
    """Result at one level, exponent and diode; shares from 0 to 1, times in s."""

    diode: str
    level_um: float
    exponent: float
    beyond_range: float
    found_share: float
    below_30_ms: float
    fullest_bin_s: float
    worst_mean_s: float
    worst_deviation_s: float

    def holds_first(self) -> bool:
        return all(self.holds()[name] for name in FIRST)

    def holds(self) -> dict[str, bool]:
        return {
            "range": self.beyond_range <= 0.01,
            "found": self.found_share == 1.0,
            "means": self.worst_mean_s < 0.06,
            "bin": abs(self.fullest_bin_s - 0.015) < 1e-6,
            "spread": self.worst_deviation_s <= 0.015,
        }


def draw_points(points: int = POINTS, seed: int = SEED) -> Iterator[tuple[str, float, float]]:
    """Draw diode, level [um] and exponent: a Latin square of levels and exponents for
    each diode.
    """
    boxes = [(diode, LEVELS_UM, EXPONENTS, points) for diode in DIODES]
    for diode, levels_um, (least, most), count in [
        *boxes,
        (BUILT, FINER_UM, FINER_EXPONENTS, min(points, FINER_POINTS)),
    ]:
        low, high = map(math.log, levels_um)
        rng = random.Random(
            f"level:{seed}:{diode}{count if diode == BUILT and count != points else ''}"
        )
        columns = [
            [(i + rng.random()) / count for i in rng.sample(range(count), count)] for _ in range(2)
        ]
        for level, exponent in zip(*columns, strict=True):
            yield diode, math.exp(low + (high - low) * level), least + (most - least) * exponent


def search(points: int = POINTS, trials: int = 120) -> list[LevelPoint]:
    article = with_variant(with_article_board(Design.load("article")), "article")
    designs = {}
    for diode in DIODES:
        threshold_v = simulate_quiescent_level(article, diode).rounded_threshold_v
        designs[diode] = Design(
            **article.with_values({"detector.threshold_v": threshold_v}).model_dump()
        )

    default = SURFACES[ARTICLE_SURFACES[0]]
    drawn = [
        *draw_points(points),
        *((diode, default.felt_um, default.felt_exponent) for diode in DIODES),
    ]
    return list(call_each(partial(try_point, designs[at[0]], *at, trials) for at in drawn))


def try_point(
    design: Design,
    diode: str,
    level_um: float,
    exponent: float,
    trials: int,
) -> LevelPoint:
    results: list[TrialResult] = []
    beyond = []
    sensing = Sensing(amplifiers="ideal", diode=diode)  # type: ignore[arg-type]
    surface = SurfaceTable(felt_um=level_um, felt_exponent=max(exponent, 1e-3))

    for case in generate_trials(trials):
        outputs = ["voltage_v", "force_n", "slip", "sampled_envelope_v", "filtered_v"]
        scene = case.scene.model_copy(
            update={"outputs": outputs, "sensing": sensing, "surface": surface}
        )
        found = run_scene(design, scene, case.seed)
        results += evaluate(
            case,
            trace=found.trace,
            detector="analog",
            design=design,
            scales=[1.0],
        )
        beyond.append(
            measure_beyond_range(design, found.columns["filtered_v"], found.columns["slip"])
        )

    pooled = pool("", design.detector.threshold_v, 0.0, results)
    figures = (
        float(np.mean(beyond)),
        pooled.found / trials,
        pooled.below_30_ms / trials,
        pooled.fullest_bin_s,
    )
    return LevelPoint(
        diode, level_um, exponent, *figures, pooled.worst_surface_s, pooled.worst_deviation_s
    )


def as_data(points: Iterable[LevelPoint]) -> list[dict[str, Any]]:
    return [
        {k: round(v, 5) if isinstance(v, float) else v for k, v in asdict(one).items()}
        for one in points
    ]


def summarise(rows: Iterable[Mapping[str, Any]]) -> dict[str, dict[str, Any]]:
    """Count, by diode, the points at which each statement holds; bound
    those at which all and the first three do.
    """
    found: dict[str, dict[str, Any]] = {}
    points = [LevelPoint(**row) for row in rows]

    for diode in DIODES:
        *mine, default = [one for one in points if one.diode == diode]
        kept = {
            name: [one for one in mine if all(one.holds()[s] for s in needed)]
            for name, needed in (("all", STATEMENTS), ("first", FIRST))
        }
        found[diode] = {
            "points": len(mine),
            "holding": {name: sum(one.holds()[name] for one in mine) for name in STATEMENTS},
            "kept": {name: _bound(some) for name, some in kept.items()},
            "default": {
                **asdict(default),
                "missed": [name for name, held in default.holds().items() if not held],
            },
        }

    return found


def _bound(points: list[LevelPoint]) -> dict[str, Any]:
    levels, exponents = (
        [getattr(one, name) for one in points] for name in ("level_um", "exponent")
    )
    ends = (
        {"level_um": [min(levels), max(levels)], "exponent": [min(exponents), max(exponents)]}
        if points
        else {}
    )
    return {"count": len(points), **ends}


def plot(rows: Iterable[Mapping[str, Any]]) -> bytes:
    """Plot all points by diode, the more statements hold the
    darker, and the default; returns a PNG.
    """
    figure = style.new_figure(10, 4)
    panels = figure.subplots(1, len(DIODES), sharey=True)
    points = [LevelPoint(**row) for row in rows]

    for axes, diode in zip(panels, DIODES, strict=True):
        *mine, default = [one for one in points if one.diode == diode]
        for one in mine:
            count = sum(one.holds().values())
            is_kept = one.holds_first()
            axes.scatter(
                one.level_um,
                one.exponent,
                s=12 + 6 * count,
                color=style.BLUE if is_kept else style.TEXT_COLOUR,
                alpha=0.9 if is_kept else 0.1 + 0.13 * count,
                linewidths=0,
            )

        axes.plot(
            default.level_um,
            default.exponent,
            "+",
            color=style.RED,
            markersize=14,
            markeredgewidth=2,
        )
        axes.set_xscale("log")
        axes.set_xticks([0.7, 1, 1.4, 2, 2.8], ["0.7", "1", "1.4", "2", "2.8"])
        axes.set_xlabel("felt roughness at Ra 1 \u00b5m [\u00b5m]")
        axes.set_title(
            f"{diode}: {sum(one.holds_first() for one in mine)} within range, found, prompt",
            loc="left",
            fontsize=10,
        )
        style.style_axes(axes)

    panels[0].set_ylabel("exponent over Ra")
    return style.to_png(figure)
