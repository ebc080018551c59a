"""The library on emulated controllers: the same decisions as here, within the limits of instructions and memory."""

from __future__ import annotations

import subprocess
from pathlib import Path

import numpy as np
import pytest

from fingertip.firmware import packaging as costs
from tests.firmware.conftest import Library, require_arm
from tools.firmware.measure import measure
from tools.firmware.signals import (
    Recording,
    slip_recording,
)
from tools.firmware.toolchain import (
    TARGETS,
    Target,
    TargetRun,
    compile_object,
    compile_target,
    run_target,
    tool_version,
)

by_target = pytest.mark.parametrize("target", TARGETS, ids=[target.name for target in TARGETS])
TOLERANCE = 0.02
"""Largest relative difference between two measurements with the same compiler: other samples of the same kind."""


def run(library: Library, target: Target, recording: Recording, level: str = "-O2") -> TargetRun:
    require_arm()
    return run_target(compile_target(library.folder, target, level), target, recording)


@pytest.mark.full
@by_target
@pytest.mark.parametrize("level", ["-O2", "-Os"])
def test_decisions_and_confidences_are_those_of_this_machine(library: Library, target: Target, level: str) -> None:
    """Both compute single precision by IEEE 754, so the numbers have the same bits."""
    recording = slip_recording(library.design, 1.5)
    found = run(library, target, recording, level)
    _, confidence, _, on = library.detector("float").process(*recording.inputs)
    assert len(found.on) == len(on)
    assert np.array_equal(found.on, on)
    assert np.array_equal(found.confidence, confidence)
    assert 0.1 < on.mean() < 0.9


@pytest.mark.full
def test_no_step_calls_a_function_on_a_controller_with_floating_point(library: Library) -> None:
    require_arm()
    floating, integer = TARGETS
    (image, _), (other, _) = (
        compile_object(library.folder, floating),
        compile_object(library.folder, integer),
    )
    assert set(undefined(image)) <= {"memset", "memcpy"}  # of slip_init
    routines = set(undefined(other)) - {"memset", "memcpy"}
    assert routines
    assert all(name.startswith(("__aeabi_f", "__aeabi_i2f")) for name in routines)


def undefined(image: Path) -> list[str]:
    done = subprocess.run(["arm-none-eabi-nm", "-u", str(image)], capture_output=True, text=True, check=True)
    return [line.split()[-1] for line in done.stdout.splitlines() if line.strip()]


def test_products_and_sums_are_not_contracted_as_arduino_compiles(library: Library, tmp_path: Path) -> None:
    """Arduino's options leave out -ffp-contract=off, so the source itself forbids it."""
    require_arm()
    source = (library.folder / "slip_detector.c").read_text()
    assert contracted(library, tmp_path, source) == 0
    assert contracted(library, tmp_path, source.replace("#pragma GCC optimize", "// ")) > 0


def contracted(library: Library, folder: Path, source: str) -> int:
    """Number of fused instructions in the code."""
    (folder / "source.c").write_text(source)
    image = folder / "source.o"
    flags = [*TARGETS[0].options, "-mthumb", "-Os", "-std=gnu11", f"-I{library.folder}", "-c"]
    subprocess.run(["arm-none-eabi-gcc", *flags, str(folder / "source.c"), "-o", str(image)], check=True)
    done = subprocess.run(["arm-none-eabi-objdump", "-d", str(image)], capture_output=True, text=True, check=True)
    return done.stdout.count("vfma") + done.stdout.count("vfms")


def assert_limits(data: dict) -> None:
    assert data["state_bytes"] <= costs.MAX_STATE_BYTES
    for target in data["targets"].values():
        assert target["flash_bytes"] <= costs.MAX_FLASH_BYTES
        assert target["stack_bytes"] <= costs.MAX_STACK_BYTES
    assert data["targets"]["Cortex-M4F"]["instructions"]["campaign"] <= costs.MAX_INSTRUCTIONS


def test_the_committed_measurements_are_within_the_limits() -> None:
    assert_limits(costs.read_costs())


@pytest.mark.full
def test_the_committed_measurements_are_measured_again(library: Library) -> None:
    """With the compiler that made the table, the same bytes and nearly the same counts; else the limits alone."""
    require_arm()
    written, found = costs.read_costs(), measure(library.design, stride=48, seconds=2.0)
    assert_limits(found)
    if tool_version("arm-none-eabi-gcc") not in written["compiler"]:
        return
    assert found["state_bytes"] == written["state_bytes"]
    for name, target in found["targets"].items():
        expected = written["targets"][name]
        assert target["flash_bytes"] == expected["flash_bytes"]
        assert target["stack_bytes"] == expected["stack_bytes"]
        assert target["max_instructions"] == pytest.approx(expected["max_instructions"], rel=TOLERANCE)
        for signal in ("quiet", "slip"):
            assert target["instructions"][signal] == pytest.approx(expected["instructions"][signal], rel=TOLERANCE)
        assert target["instructions"]["campaign"] == pytest.approx(expected["instructions"]["campaign"], rel=0.1)
