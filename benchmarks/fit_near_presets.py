"""Share of the designs near bundled ones that a fit makes valid, with the loads that they state.

    python benchmarks/fit_near_presets.py [designs] [seed] [way]

Sizes of finger, hand and loads are drawn within 15 % of each bundled design in turn. Three ways to
draw are compared:

- kept: all of them are drawn, and the fit leaves them alone.
- few: three of them are drawn, and the fit leaves these alone.
- begun: all are drawn; those that follow from others are where the fit begins.

A fitted design is valid if the checks of its build pass, but for B-rep. A refusal is tried again
with its remedy.
"""

from __future__ import annotations

import random
import statistics
import sys
import time
import warnings
from collections import Counter

from fingertip.cad.verification.verify import check
from fingertip.catalogues.file_kinds import DESIGN, PRESETS, find_file
from fingertip.design import Design
from fingertip.design.design_file import flatten, load_tables
from fingertip.design.fit import DERIVED
from fingertip.design.geometry import DesignTables
from fingertip.design.parameters import PARAMETERS
from fingertip.fitting.fitting import fit_finger
from fingertip.foundation.errors import DesignError
from tools.fuzz.remedies import as_changes

BASES = (*PRESETS, "fsr400", "fsr402", "first_finger", "article")
DRAWN = (
    "skin.width_mm",
    "skin.length_mm",
    "skin.semi_axis_palmar_mm",
    "skin.thickness_palmar_mm",
    "skin.crown_radius_mm",
    "bone.base_length_mm",
    "bone.collar_length_mm",
    "bone.platform_mm",
    "hand.width_mm",
    "hand.pin_diameter_mm",
    "hand.axis_height_mm",
    "hand.tendon_distance_mm",
    "hand.travel_deg",
    "strength.grip_force_n",
    "strength.knock_speed_m_s",
)
WAYS = ("kept", "few", "begun")
SHARE = 0.15
FEW = 3
SEED = 20261128


def draw(number: int, way: str, seed: int) -> tuple[DesignTables, tuple[str, ...], DesignTables]:
    """Draw a design; return it with the names that are given, and the bundled design beside it."""
    rng = random.Random(f"{seed}.{way}.{number}")
    base = DesignTables(**load_tables([find_file(BASES[number % len(BASES)], DESIGN)], []).tables)
    names = rng.sample(DRAWN, FEW) if way == "few" else DRAWN
    values = {
        name: round(base.value(name) * rng.uniform(1 - SHARE, 1 + SHARE), 2) for name in names
    }
    given = tuple(name for name in names if way != "begun" or name not in DERIVED)

    return base.with_values(values), given, base


def judge(number: int, way: str, seed: int) -> tuple[str, float, float]:
    """Fit a drawn design; return what became of it, and the CPU
    time [s] of its fit and of its checks.
    """
    tables, given, before = draw(number, way, seed)
    start = time.process_time()

    try:
        fitted = fit_finger(tables, given, before).tables
    except DesignError as error:
        seconds = time.process_time() - start
        kind = "loads refused" if str(error).startswith("strength.") else "sizes refused"
        remedy = flatten(load_tables((), as_changes(error.issues)).tables)
        typed = tables.with_values({name: value for name, value in remedy if name in PARAMETERS})

        try:
            fit_finger(typed, given, before)
        except DesignError:
            return "remedy fails", seconds, 0.0

        return kind, seconds, 0.0

    end = time.process_time()
    failed = [
        each.name
        for each in check(Design.model_construct(None, **dict(fitted))).checks
        if not each.passed
    ]
    return ", ".join(["fitted", *failed]), end - start, time.process_time() - end


def main() -> None:
    """Print a line for each way to draw."""
    warnings.simplefilter("ignore")
    count = int(sys.argv[1]) if len(sys.argv) > 1 else 500
    seed = int(sys.argv[2]) if len(sys.argv) > 2 else SEED
    judge(0, "few", 0)  # imports

    for way in sys.argv[3:] or WAYS:
        found = [judge(number, way, seed) for number in range(count)]
        print(way, dict(Counter(kind for kind, _, _ in found)))
        for name, seconds in zip(
            ("fit", "checks"), list(zip(*found, strict=True))[1:], strict=True
        ):
            p99 = statistics.quantiles(seconds, n=100)[-1]
            print(
                f"  {name}: median {statistics.median(seconds):.2f} s, p99 {p99:.2f} s, most "
                f"{max(seconds):.2f} s"
            )


if __name__ == "__main__":
    main()
