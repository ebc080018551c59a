"""Share of the fingers near a preset that can be made, as they are and after the fit of `fingertip new`.

    python benchmarks/fit_near_presets.py [fingers]

Eight sizes of finger and hand are drawn within 20 % of each preset in turn. The fit leaves them alone.
"""

from __future__ import annotations

import random
import statistics
import sys
import time

from fingertip.catalogues.file_kinds import DESIGN, find_file
from fingertip.design.files import load_tables
from fingertip.design.fit import fit_design
from fingertip.design.geometry import DesignTables
from fingertip.design.new_design import PRESETS
from fingertip.design.rules.ruleset import find_violations
from fingertip.design.search import PART_RULES
from fingertip.foundation.errors import DesignError

MEASURED = (
    "skin.width_mm", "skin.length_mm", "skin.semi_axis_palmar_mm", "skin.semi_axis_dorsal_mm", "hand.width_mm",
    "hand.axis_height_mm", "hand.pin_diameter_mm", "hand.clearance_radius_mm",
)  # fmt: skip
SHARE, SEED = 0.2, 11


def draw(preset: str, rng: random.Random) -> DesignTables:
    """Draw the measured sizes around those of a preset."""
    base = DesignTables(**load_tables([find_file(preset, DESIGN)], []).tables)
    return base.with_values({n: round(base.value(n) * rng.uniform(1 - SHARE, 1 + SHARE), 2) for n in MEASURED})


def main() -> None:
    """Print a line for each preset, and the time of the fits."""
    rng, seconds = random.Random(SEED), []
    counts = {preset: [0, 0, 0] for preset in PRESETS}  # drawn, passing as drawn, passing after the fit
    for i in range(int(sys.argv[1]) if len(sys.argv) > 1 else 48):
        preset = PRESETS[i % len(PRESETS)]
        drawn = draw(preset, rng)
        counts[preset][0] += 1
        counts[preset][1] += not list(find_violations(PART_RULES, drawn))
        start = time.process_time()
        try:
            fit_design(drawn, MEASURED)
            counts[preset][2] += 1
        except DesignError:
            pass
        seconds.append(time.process_time() - start)
    print(f"{'preset':14} {'drawn':>6} {'as drawn':>9} {'fitted':>7}")
    total = [sum(column) for column in zip(*counts.values(), strict=True)]
    for name, (drawn_count, plain, fitted) in (*counts.items(), ("all", total)):
        print(f"{name:14} {drawn_count:6} {plain:9} {fitted:7}")
    median, p90 = statistics.median(seconds), statistics.quantiles(seconds, n=10)[-1]
    print(f"time of a fit, accepted or refused: median {median:.1f} s, p90 {p90:.1f} s, worst {max(seconds):.1f} s")


if __name__ == "__main__":
    main()
