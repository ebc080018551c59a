"""Fit the small table of the detector `fast`.

    python -m tools.detector_training.fit FOLDER --out FILE [--sizes 1000] [--draws 3] [--small]

Needs scikit-learn, which the package does not. FOLDER holds the public sets of
`benchmarks.slip.real_sets`: the halves for tuning are trained on. Each draw takes other seeds of
the generators. Each table is run over the tuning half of the fair bench, and the draw whose number
of alarms is the median is written; several sizes print their curve, and the last is written.
`--small` fits in a minute, without real sets, to see that the same versions of Python, numpy and
scikit-learn still give the same table.
"""

from __future__ import annotations

import argparse
import platform
from collections.abc import Sequence
from dataclasses import dataclass
from importlib import metadata
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from benchmarks.slip.bench import Results, measure, select
from benchmarks.slip.competitors import Row
from benchmarks.slip.goals import BURST, STEADY
from benchmarks.slip.mix import MixSize
from benchmarks.slip.own_sets import LINES, TUNING
from benchmarks.slip.real import hash_sets, list_sources
from benchmarks.slip.real_sets import SLIDES, RealSet, list_real
from fingertip.design import Design
from fingertip.foundation.workers import count_processors, side_by_side
from fingertip.slip.detectors.fast_table import (
    ALWAYS_LEFT,
    DEPTH,
    NODES,
    TABLE,
    BlowTable,
    write_table,
)
from tools.detector_training.rows import Rows, collect_all, weigh
from tools.detector_training.signals import SEEDS, SHARE, list_own_training, list_training

PLAN = {40: (1, 1.0), 200: (6, 0.6), 1000: (33, 0.25), 3000: (97, 0.15)}
"""Size, about, in thresholds, leaves and offset -> number of trees, and rate of learning."""
LEAVES_PENALTY = 5.0
LEAST_ROWS = 60
"""Regularisation of the leaves, and least number of rows in one."""
SMALL_SEEDS = (1001,)
SMALL_SHARE = 0.05
SMALL_COUNT = 4
SMALL_MIX = MixSize(events=4, noisy=2)
SMALL_SIZE = 200
BENCH_SHARE = 0.1
BENCH_TRIALS = 30
"""Share of the project's own signals on which a table is chosen, for each of five seeds, and number
of trials with each design.
"""


def main(words: Sequence[str] | None = None) -> None:
    """Fit, print what each table reaches, and write one."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("folder", nargs="?", type=Path)
    parser.add_argument("--out", type=Path, default=Path(TABLE))
    parser.add_argument("--sizes", type=int, nargs="+", default=[1000], choices=list(PLAN))
    parser.add_argument("--draws", type=int, default=len(SEEDS), choices=range(1, len(SEEDS) + 1))
    parser.add_argument("--small", action="store_true", help="fit to a few own signals alone")
    options = parser.parse_args(words)

    with side_by_side(count_processors()):
        if options.small:
            write_small(options.out)
        elif options.folder is None:
            parser.error("the folder of the public sets is missing")
        else:
            fit_all(options.folder, options.out, options.sizes, options.draws)


def write_small(out: Path) -> None:
    """Fit a table to a few signals of the project's own."""
    sources = list_own_training(SMALL_SEEDS, SMALL_SHARE, SMALL_COUNT, SMALL_COUNT, SMALL_MIX)
    table = fit(collect_all(sources), SMALL_SIZE)
    card = make_card(table, {"seeds": SMALL_SEEDS, "share": SMALL_SHARE})
    out.write_text(write_table(table, card), encoding="utf-8")


def fit_all(folder: Path, out: Path, sizes: Sequence[int], draws: int) -> None:
    """Fit tables of some sizes to each draw, and write the median of the last size."""
    sets = list_real(folder, TUNING)
    files = hash_sets(sets)
    judged = dict[int, list[Judged]]()
    for draw in range(draws):
        rows = collect_all(list_training(folder, draw))
        print(f"draw {draw}: {len(rows.is_slip)} rows, {100 * rows.is_slip.mean():.0f} % slip")
        for size in sizes:
            table = fit(rows, size)
            card = make_card(table, {"seeds": SEEDS[draw], "share": SHARE, "files": files})
            path = out.with_stem(f"{out.stem}_{size}_{draw}")
            path.write_text(write_table(table, card), encoding="utf-8")
            judged.setdefault(size, []).append(judge(path, sets))
            print(f"{table.numbers} numbers, draw {draw}: {judged[size][-1].words}", flush=True)

    ranked = sorted(judged[sizes[-1]], key=lambda one: one.alarms)
    median = ranked[(len(ranked) - 1) // 2]
    out.write_text(median.path.read_text(encoding="utf-8"), encoding="utf-8")
    print(f"wrote {median.path.stem} to {out}")


def fit(rows: Rows, size: int) -> BlowTable:
    """Fit boosted trees of a size to rows, and complete each to `DEPTH` levels."""
    from sklearn.ensemble import HistGradientBoostingClassifier

    trees, learning_rate = PLAN[size]
    boosted = HistGradientBoostingClassifier(
        max_iter=trees,
        max_depth=DEPTH,
        max_leaf_nodes=NODES + 1,
        learning_rate=learning_rate,
        l2_regularization=LEAVES_PENALTY,
        min_samples_leaf=LEAST_ROWS,
        max_bins=128,
        early_stopping=False,
        random_state=0,
    )
    boosted.fit(rows.features, rows.is_slip, sample_weight=weigh(rows))
    parts = [complete(predictor.nodes) for (predictor,) in boosted._predictors]
    return BlowTable(
        features=np.array([part.features for part in parts]),
        thresholds=np.array([part.thresholds for part in parts], dtype=np.float32),
        leaves=np.array([part.leaves for part in parts], dtype=np.float32),
        offset=np.float32(boosted._baseline_prediction.ravel()[0]),
    )


@dataclass(frozen=True, eq=False)
class Tree:
    features: NDArray[np.int64]
    thresholds: NDArray[np.float64]
    leaves: NDArray[np.float64]


def complete(nodes: Any) -> Tree:
    """Complete a tree to `DEPTH` levels: a leaf further up fills the whole branch below it."""
    features = np.zeros(NODES, dtype=np.int64)
    thresholds = np.full(NODES, ALWAYS_LEFT)
    leaves = np.zeros(NODES + 1)

    def place(source: int, node: int) -> None:
        record = nodes[source]
        if node >= NODES:
            leaves[node - NODES] = record["value"]
        elif record["is_leaf"]:
            place(source, 2 * node + 1)
            place(source, 2 * node + 2)
        else:
            features[node] = record["feature_idx"]
            thresholds[node] = record["num_threshold"]
            place(int(record["left"]), 2 * node + 1)
            place(int(record["right"]), 2 * node + 2)

    place(0, 0)
    return Tree(features, thresholds, leaves)


@dataclass(frozen=True)
class Judged:
    """What a table reaches on the tuning half of the fair bench."""

    path: Path
    alarms: float
    """Alarms on real grasps, doubled, in the steady lines and in hum, and percent of hits taken."""
    words: str


def judge(path: Path, sets: Sequence[RealSet]) -> Judged:
    """Run `fast` with a table over the tuning half."""
    row = Row(str(path))
    sources = list_sources(sets, TUNING, BENCH_SHARE, BENCH_TRIALS)
    found = select(measure(Design.load("article"), [row], sources, (1.0,)), row)
    steady = [kind for line in STEADY for kind in LINES[line]]
    grasps = found.of("grasp", run=0).counted
    hits = 100 * found.of("stick hit").taken_share
    hum = found.of(*LINES["late hum"]).counted
    alarms = found.of(*steady).counted
    taken = ", ".join(
        f"{100 * found.of(*LINES[k]).taken_share:.0f}" for k in ("taps", "knocks", "rings")
    )
    words = (
        f"grasps {grasps}, slides {describe(found, *SLIDES)}, hits {hits:.0f} %, steady lines "
        f"{alarms}, hum {hum}, taps, knocks and rings {taken} %, bursts {describe(found, BURST)}, "
        f"trials {describe(found, *list_trials(found))}"
    )
    return Judged(path, 2 * grasps + alarms + hum + hits, words)


def list_trials(found: Results) -> list[str]:
    return sorted({kind for kind, _ in found.by_kind if kind.startswith("trials")})


def describe(found: Results, *kinds: str) -> str:
    """Describe how late each kind of slips was found, and how long it was ON."""
    tallies = [found.of(kind) for kind in kinds]
    late = ", ".join(f"{one.quantile_ms(0.9):.0f}" for one in tallies)
    return f"{late} ms (ON {', '.join(f'{one.on_share:.3f}' for one in tallies)})"


def make_card(table: BlowTable, signals: dict[str, Any]) -> dict[str, Any]:
    """State what a table was fitted to, and with what: the same card gives the same bytes."""
    versions = {"python": platform.python_version()}
    versions |= {name: metadata.version(name) for name in ("numpy", "scipy", "scikit-learn")}
    return {"numbers": table.numbers, "versions": versions, **signals}


if __name__ == "__main__":
    main()
