"""Run one simulation with a detector in the loop: the hand tightens its grip when the detector finds slip."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

from fingertip.campaign.closed_loop.grip import Grip, GripSettings
from fingertip.errors import FingertipError, Issue
from fingertip.sim import ManipulationFile, ManipulationResult, Simulation, run_manipulation
from fingertip.slip.detectors.registry import DETECTORS, find_detector_type


@dataclass(frozen=True, eq=False)
class GrippedResult:
    """Result of a manipulation with a detector in the loop."""

    result: ManipulationResult
    grips_s: tuple[float, ...]
    """Moments at which the hand tightened its grip [s]."""


def find_grip_issues(detector: str, simulation: Simulation | None) -> list[Issue]:
    """Report an unknown detector, and a simulation without a hand. None stands for a simulation that did not load."""
    issues = []
    if simulation and not isinstance(simulation.scene, ManipulationFile):
        remedy = "give a manipulation, such as params/scenes/real_manipulation.toml"
        issues.append(Issue("--grip", f"closes the loop of a hand; {remedy}."))
    try:
        find_detector_type(detector)
    except FingertipError as error:
        issues += [Issue("--grip", issue.message) for issue in error.issues]
    return issues


def run_with_grip(
    simulation: Simulation, detector: str = "fast", progress: Callable[[str], None] | None = None
) -> GrippedResult:
    """Run a manipulation in which the hand tightens its grip when a detector finds slip.

    Parameters
    ----------
    simulation
        Simulation of a manipulation, such as `fingertip.sim.load_simulation` returns. The signal that the detector
        reads is added to its outputs.
    detector
        Name of the detector.
    progress
        Receives progress messages.

    Raises
    ------
    FingertipError
        If there is no such detector, or the simulation has no hand.
    """
    scene, design = simulation.scene, simulation.design
    if issues := find_grip_issues(detector, simulation):
        raise FingertipError(issues)
    assert isinstance(scene, ManipulationFile)
    column = DETECTORS[detector].reads
    if column not in scene.outputs:
        scene = scene.model_copy(update={"outputs": [*scene.outputs, column]})
    grip = Grip(design, GripSettings(detector), len(scene.fingers))
    result = run_manipulation(design, scene, grip, simulation.seed, progress)
    return GrippedResult(result, tuple(look.time_s for look in grip.looks if look.gripped))
