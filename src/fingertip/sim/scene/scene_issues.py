"""Reasons why a scene cannot be simulated with a design."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

from fingertip.design import Design
from fingertip.design.signal_ground import CONTROLLER_SUPPLIES
from fingertip.errors import Issue
from fingertip.sim.scene.scene_file import SceneFile
from fingertip.sim.signal.comparator import describe_missing_comparator


def find_scene_issues(design: Design, scene: SceneFile, seed: int) -> Iterator[Issue]:
    """Yield the reasons why a scene cannot be simulated with a design."""
    if seed < 0:
        yield Issue("--seed", f"{seed} is negative; choose a whole number of at least 0.")
    if "slip_pin_v" in scene.outputs and design.board.variant != "comparator":
        yield Issue("outputs", describe_missing_comparator(design))
    yield from find_filtered_issues(design, scene.outputs)
    half = design.detector.sample_rate_hz / 2
    if scene.motor.force_n and scene.motor.frequency_hz >= half:
        message = f"{scene.motor.frequency_hz:g} Hz is not below half of detector.sample_rate_hz; below {half:g} Hz."
        yield Issue("motor.frequency_hz", message)


def find_filtered_issues(design: Design, outputs: Sequence[str]) -> Iterator[Issue]:
    """Yield an issue if outputs name the filtered signal, and the design's board does not give it to a controller."""
    if "sampled_filtered_v" in outputs and design.board.supply not in CONTROLLER_SUPPLIES:
        message = (
            "'sampled_filtered_v' exists on boards with the filtered signal at their connector, and this design's "
            f"board.supply is {design.board.supply}; use --set board.supply=single_3v3 --set board.supply_v=3.3."
        )
        yield Issue("outputs", message)
