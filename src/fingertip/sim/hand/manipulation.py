"""Real manipulation: an object is grasped, knocked, and held or lost, with a controller in the loop or none.

`run_manipulation` steps hand, contact and sensors from one command to the next. The controller is handed what a real
one would be, sampled voltages and the motors' closing (`fingertip.sim.Seen`), and nothing of the truth. Anything with a
method ``step`` is one; detectors and grip laws are the caller's, this package knows none.

Taken for simple, all assumptions: the object moves along one line, in which it would slip and its weight pulls (once
whoever holds it lets go), does not turn, and is rigid; of a power grasp the palm carries nothing; the thumb's abduction
stays, as in the article (IV.A); a finger is stiff along that line up to its pad; vibration does not act back on
friction; a pad's stiffness and resonance stay those of the force it was to hold with.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import Any

import numpy as np
from numpy.typing import NDArray

from fingertip.arrays import Array
from fingertip.design import Design
from fingertip.errors import Issue, TraceError
from fingertip.sim.contact.pad import Pad
from fingertip.sim.electronics.comparator import missing, pin_v
from fingertip.sim.hand.controller import Controller, Seen
from fingertip.sim.hand.manipulated import Manipulated
from fingertip.sim.hand.manipulation_file import OUTPUTS, ManipulationFile
from fingertip.sim.hand.motion_plan import Plan, plan, thumb_n
from fingertip.sim.hand.stepper import Run
from fingertip.sim.stages.result import LONG_S
from fingertip.sim.validation import refuse


def run_manipulation(
    design: Design,
    scene: ManipulationFile,
    controller: Controller | None = None,
    seed: int = 0,
    progress: Callable[[str], None] | None = None,
) -> Manipulated:
    """Simulate a manipulation.

    Parameters
    ----------
    design
        Gives the pads' form, the board, the converter and its noise; all fingers are alike.
    scene
        Object, grasp, knock and hand, and which outputs are wanted.
    controller
        Closes the loop; None keeps the planned grip.
    seed
        Of grip, friction, surfaces and noise. The same design, scene, seed and commands give the same columns.
    progress
        Told of progress, where a scene is long enough to need it.

    Raises
    ------
    TraceError
        If the seed is negative, the plan asks more than a finger can press with, or a controller's command is none.
    """
    pad = Pad.of(design)
    _refuse(design, scene, seed)
    made = plan(scene, pad, seed)
    if progress and made.duration_s > LONG_S:
        progress(f"{scene.scene}, {made.duration_s:.1f} s")
    wanted = frozenset(scene.outputs) | ({"voltage_v"} if controller else set())
    run = Run(design, scene, made, pad, seed, wanted)
    rate = design.detector.sample_rate_hz
    count = math.ceil(made.duration_s * rate)
    period, delay = max(1, round(scene.hand.period_s * rate)), round(scene.hand.delay_s * rate)
    starts = range(0, count, period)
    if controller is None:
        # Nobody looks on the way, so it is stepped at once.
        told = made.planned_m(np.array(starts) / rate)
        run.advance(_in_force(told, 0, count, period, delay))
    else:
        told = np.zeros((len(scene.fingers), len(starts)))
        for i, start in enumerate(starts):
            planned = made.planned_m(np.array([start / rate]))[:, 0]
            assert run.samples
            voltage, enveloped = run.samples.voltage_v, run.samples.envelope_v
            seen = Seen(start / rate, voltage.copy(), run.motors.closing_m.copy(), planned, enveloped)
            told[:, i] = _command(controller.step(seen), start / rate, len(scene.fingers))
            run.advance(_in_force(told, start, min(start + period, count), period, delay))
    return _result(design, scene, seed, made, run, count)


def _in_force(told: Array, start: int, end: int, period: int, delay: int) -> Array:
    """The command in force before each sample after `start`: told at i * period, it takes `delay` samples."""
    latest = (np.arange(start, end) - delay) // period
    return np.where(latest >= 0, told[:, np.maximum(latest, 0)], 0.0)


def _command(given: Array, time_s: float, count: int) -> Array:
    command = np.asarray(given, dtype=np.float64)
    if command.shape != (count,):
        sentence = f"gave shape {command.shape} at {time_s:g} s, needed is ({count},); give one closing per finger."
        raise TraceError(Issue("controller", sentence))
    if not np.isfinite(command).all():
        bad = int(np.flatnonzero(~np.isfinite(command))[0])
        sentence = f"gave {command[bad]} for finger {bad} at {time_s:g} s; give finite closings [m]."
        raise TraceError(Issue("controller", sentence))
    return command


def _result(design: Design, scene: ManipulationFile, seed: int, made: Plan, run: Run, count: int) -> Manipulated:
    signals: dict[str, NDArray[Any]] = {name: np.concatenate(parts, axis=-1) for name, parts in run.parts.items()}
    step = 1 / design.detector.sample_rate_hz
    time_s = np.arange(count + 1, dtype=np.float64) * step
    if "slip_pin_v" in scene.outputs:
        outs = zip(signals["filtered_v"], signals["envelope_v"], strict=True)
        signals["slip_pin_v"] = np.stack([pin_v(design, step, *out) for out in outs])
    gone = np.flatnonzero(signals["object_m"] >= scene.object.length_m)
    lost_s = float(time_s[gone[0]]) if run.lost else None
    if "force_n" not in scene.outputs:
        signals.pop("force_n")
    signals = {name: signals[name] for name in OUTPUTS if name in signals}
    return Manipulated(scene, seed, made, time_s, signals, lost_s, tuple(run.ran.values()))


def _refuse(design: Design, scene: ManipulationFile, seed: int) -> None:
    issues = []
    if seed < 0:
        issues.append(Issue("--seed", f"{seed} is negative; choose a whole number of at least 0."))
    held, maximum = scene.object, thumb_n(scene, scene.grasp.max_margin)
    if maximum > scene.hand.max_force_n:
        sentence = f"{scene.hand.max_force_n:g} N is less than the thumb needs for {held.mass_kg:g} kg; at least {maximum:g} N."
        issues.append(Issue("hand.max_force_n", sentence))
    if "slip_pin_v" in scene.outputs and design.board.variant != "comparator":
        issues.append(Issue("outputs", missing(design)))
    refuse(issues)
