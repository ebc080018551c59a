"""Measure what the library costs on a controller, and write `measured_costs.json` of
`fingertip.firmware`.

Run ``python -m tools.firmware.measure``. It needs gcc, gcc-arm-none-eabi and qemu-system-arm
(`.ci/install-firmware`).
"""

from __future__ import annotations

import json
import tempfile
from pathlib import Path
from typing import Any

import numpy as np

from fingertip.design import Design
from fingertip.firmware import measured_costs
from fingertip.slip.detectors.fast_settings import TICK_S
from tools.firmware.signals import Recording, campaign_recordings, quiet_recording, slip_recording
from tools.firmware.toolchain import (
    FIVE,
    TARGETS,
    HostDetector,
    Target,
    compile_host,
    compile_target,
    measure_flash,
    run_hand_on_target,
    run_target,
    tool_version,
    write_sources,
)

STRIDE = 24
"""One of so many cases of the campaign is run on the controllers."""
SECONDS = 4.0
"""Duration of the quiet and of the slip signal [s]."""


def measure(design: Design, stride: int = STRIDE, seconds: float = SECONDS) -> dict[str, Any]:
    """Measure the costs on every target, as plain data."""
    signals = {
        "campaign": list(campaign_recordings(design, stride)),
        "quiet": [quiet_recording(design, seconds)],
        "slip": [slip_recording(design, seconds)],
    }
    with tempfile.TemporaryDirectory() as temporary:
        folder = Path(temporary)
        write_sources(design, folder)
        hand = folder / "hand"
        hand.mkdir()
        write_sources(design, hand, FIVE)
        state = HostDetector(compile_host(folder)).state_bytes
        return {
            "design": design.name,
            "board": design.board.variant,
            "sample_rate_hz": design.detector.sample_rate_hz,
            "compiler": f"arm-none-eabi-gcc {tool_version('arm-none-eabi-gcc')}",
            "emulator": f"QEMU {tool_version('qemu-system-arm')}",
            "options": "-O2",
            "state_bytes": state,
            "samples": {
                name: sum(len(one.tactile_v) for one in several)
                for name, several in signals.items()
            },
            "targets": {
                target.name: _measure_target(design, folder, target, signals)
                | {"five_fingers": _measure_hand(design, hand, target, seconds)}
                for target in TARGETS
            },
        }


def _measure_target(
    design: Design, folder: Path, target: Target, signals: dict[str, list[Recording]]
) -> dict[str, Any]:
    image = compile_target(folder, target)
    runs = {
        name: [run_target(image, target, one) for one in several]
        for name, several in signals.items()
    }
    counts = {
        name: np.concatenate([run.instructions for run in several])
        for name, several in runs.items()
    }
    tick = round(TICK_S * design.detector.sample_rate_hz)
    settled = {
        name: each if name == "campaign" else each[len(each) // 2 :]
        for name, each in counts.items()
    }

    return {
        "emulated": target.emulated,
        "flash_bytes": measure_flash(folder, target),
        "stack_bytes": max(run.stack_bytes for several in runs.values() for run in several),
        "instructions": {name: round(float(np.mean(each))) for name, each in settled.items()},
        "short_instructions": round(
            float(np.quantile(np.concatenate(list(counts.values())), 1 - 1.1 / tick))
        ),
        "max_instructions": round(max(float(each.max()) for each in counts.values())),
    }


def _measure_hand(design: Design, folder: Path, target: Target, seconds: float) -> dict[str, Any]:
    """Measure the detectors of five fingers, all of which slip: mean of the second half, and most
    of a sample.
    """
    fingers = [
        slip_recording(design, seconds, 2 + 2 * i).code_pairs(design) for i in range(FIVE.count)
    ]
    codes = np.stack(fingers, axis=1)
    _, counts = run_hand_on_target(
        compile_target(folder, target, program="hand_on_target.c"), target, codes
    )
    costs = {"flash_bytes": measure_flash(folder, target, with_grip=True)}

    return costs | {
        "slip": round(float(np.mean(counts[len(counts) // 2 :]))),
        "max": round(float(counts.max())),
    }


def main() -> None:
    """Measure the default design, and replace the table in the package."""
    path = Path(measured_costs.__file__).with_name(measured_costs.TABLE)
    path.write_text(json.dumps(measure(Design()), indent=2) + "\n", encoding="utf-8")
    print(path.read_text(encoding="utf-8"))


if __name__ == "__main__":
    main()
