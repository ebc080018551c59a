"""Measure what the library costs on a controller, and write `measured_costs.json` of `fingertip.firmware`.

Run ``python -m tools.firmware.measure``. It needs gcc, gcc-arm-none-eabi and qemu-system-arm (`.ci/install-firmware`).
"""

from __future__ import annotations

import json
import tempfile
from pathlib import Path
from typing import Any

import numpy as np

from fingertip.design import Design
from fingertip.firmware import costs
from tools.firmware.signals import campaign_voltages, quiet_voltage, slip_voltage
from tools.firmware.toolchain import (
    TARGETS,
    HostDetector,
    Target,
    compile_host,
    compile_target,
    measure_flash,
    run_target,
    tool_version,
    write_sources,
)

STRIDE = 12
"""One of so many cases of the campaign is run on the controllers."""
SECONDS = 10.0
"""Duration of the quiet and of the slip signal [s]."""


def measure(design: Design, stride: int = STRIDE, seconds: float = SECONDS) -> dict[str, Any]:
    """Measure the costs on every target, as plain data."""
    signals = {
        "campaign": np.concatenate(list(campaign_voltages(design, stride))),
        "quiet": quiet_voltage(design, seconds),
        "slip": slip_voltage(design, seconds),
    }
    with tempfile.TemporaryDirectory() as temporary:
        folder = Path(temporary)
        write_sources(design, folder)
        state = HostDetector(compile_host(folder, "float"), "float").state_bytes
        return {
            "design": design.name,
            "sample_rate_hz": design.detector.sample_rate_hz,
            "compiler": f"arm-none-eabi-gcc {tool_version('arm-none-eabi-gcc')}",
            "emulator": f"QEMU {tool_version('qemu-system-arm')}",
            "options": "-O2",
            "state_bytes": state,
            "samples": {name: len(volts) for name, volts in signals.items()},
            "targets": {target.name: _measure_target(folder, target, signals) for target in TARGETS},
        }


def _measure_target(folder: Path, target: Target, signals: dict[str, Any]) -> dict[str, Any]:
    image = compile_target(folder, target)
    runs = {name: run_target(image, target, volts) for name, volts in signals.items()}
    settled = {
        name: run.instructions[-len(run.instructions) // 2 :] for name, run in runs.items() if name != "campaign"
    }
    means = {"campaign": runs["campaign"].instructions} | settled
    return {
        "emulated": target.emulated,
        "flash_bytes": measure_flash(folder, target),
        "stack_bytes": max(run.stack_bytes for run in runs.values()),
        "instructions": {name: round(float(np.mean(counts))) for name, counts in means.items()},
        "max_instructions": round(max(float(run.instructions.max()) for run in runs.values())),
    }


def main() -> None:
    """Measure the default design, and replace the table in the package."""
    path = Path(costs.__file__).with_name(costs.TABLE)
    path.write_text(json.dumps(measure(Design()), indent=2) + "\n", encoding="utf-8")
    print(path.read_text(encoding="utf-8"))


if __name__ == "__main__":
    main()
