"""A case as it would be recorded: voltage and, of the filter board, envelope, both through the converter."""

from __future__ import annotations

import random
from dataclasses import replace

from fingertip.arrays import Array
from fingertip.campaign.plan import Case
from fingertip.design import Design
from fingertip.sim import run_scene
from fingertip.sim.electronics.anti_alias import Poles
from fingertip.sim.electronics.converter import sampled_v
from fingertip.slip import DETECTORS, Trace


def record(design: Design, case: Case, board: bool = True) -> tuple[Trace, float]:
    """The trace of a case with its truth, and the force that holds [N].

    Parameters
    ----------
    design
        Its sensor, bridge, board and converter.
    case
        What happens.
    board
        Whether the board's output is wanted too.
    """
    outputs = ["voltage_v", "force_n", "slip", *(["envelope_v"] if board else [])]
    made = run_scene(design, case.scene.model_copy(update={"outputs": outputs}), case.seed)
    if not board:
        return made.trace, made.force_n
    at_pin = Poles.envelope(design).process(made.columns["envelope_v"])
    sampled = sampled_v(design, at_pin, random.Random(f"{case.seed}:noise of the envelope"))
    return replace(made.trace, envelope_v=sampled), made.force_n


def reads_board(*detectors: str) -> bool:
    """Whether any of the detectors takes the board's output."""
    return any(DETECTORS[name].reads == "envelope_v" for name in detectors)


def samples(trace: Trace, detector: str) -> Array:
    """The column that a detector takes."""
    column: Array | None = getattr(trace, DETECTORS[detector].reads)
    assert column is not None
    return column
