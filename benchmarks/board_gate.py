"""Share of random boards that the gate accepts, and whether each accepted one holds its conditions
in ngspice.

Run `python -m benchmarks.board_gate` in the repository; it needs ngspice. Cutoffs lie between 30
and 150 Hz and gains between 20 and 150, evenly by ratio, on every variant and supply. The rest
stays at its default.
"""

from __future__ import annotations

import math
import random
import shutil
import sys
import tempfile
from collections import Counter
from pathlib import Path

from benchmarks.gate_in_ngspice import check_gate_in_ngspice
from fingertip.board.analysis.board_values import board_values
from fingertip.board.analysis.gate import gate_warnings
from fingertip.board.components.values import VARIANT_CHANGES
from fingertip.design import Design
from fingertip.foundation.errors import DesignError

SETTINGS = 300
CUTOFF_HZ = (30.0, 150.0)
GAIN = (20.0, 150.0)


def random_changes(seed: int, count: int = SETTINGS) -> list[list[str]]:
    """Draw the changes of random settings, every variant equally often."""
    draw = random.Random(seed)
    names = list(VARIANT_CHANGES.values())

    def between(low: float, high: float) -> float:
        return float(f"{math.exp(draw.uniform(math.log(low), math.log(high))):.4g}")

    return [
        [
            *names[i % len(names)],
            f"board.cutoff_hz={between(*CUTOFF_HZ)}",
            f"board.passband_gain={between(*GAIN)}",
        ]
        for i in range(count)
    ]


def main() -> int:
    """Run all settings and print what was accepted and what failed."""
    program = shutil.which("ngspice")
    if program is None:
        print("ngspice is not installed; run `sh .ci/install-ngspice` as root on Debian.")
        return 2

    refused = Counter[str]()
    accepted = 0
    failed = 0
    warned = 0
    peaking_db = -math.inf
    current = 0.0
    margin_v = math.inf

    with tempfile.TemporaryDirectory() as folder:
        for changes in random_changes(1):
            try:
                design = Design.load(changes=changes)
            except DesignError as error:
                refused[error.issues[0].field] += 1
                continue

            accepted += 1
            conditions = board_values(design).gate
            missed = [c.name for c in conditions if c.level == "required" and not c.passed]
            warned += any(True for _ in gate_warnings(conditions))
            found = check_gate_in_ngspice(program, Path(folder), design)
            peaking_db = max(peaking_db, found.peaking_db)
            current = max(
                current, *(i / found.current_limits_a[n] for n, i in found.currents_a.items())
            )
            margin_v = min(margin_v, *found.margins_v.values())

            if found.failures or missed:
                failed += 1
                print(f"{' '.join(changes)}: {', '.join([*found.failures, *missed])}")

    print(
        f"{accepted} of {SETTINGS} accepted ({100 * accepted / SETTINGS:.0f} %); refused: "
        f"{dict(refused)}"
    )
    print(
        f"{failed} of the accepted fail a condition in ngspice or in the gate; {warned} have a "
        "warning"
    )
    print(
        f"largest gain over the passband's {peaking_db:.2f} dB, largest current "
        f"{100 * current:.0f} % of the data "
        f"sheet's, smallest distance from the end of an output's range {margin_v:.2f} V"
    )
    return 1 if failed or accepted < 0.6 * SETTINGS else 0


if __name__ == "__main__":
    sys.exit(main())
