"""Run a scene for a design; the columns it gives, and the files they go to."""

from __future__ import annotations

import io
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from fingertip.design import Design
from fingertip.errors import Fault, TraceError
from fingertip.sim.pipeline import Context, stages_of
from fingertip.sim.scene_file import SceneFile
from fingertip.sim.stages import Ran, run
from fingertip.slip.trace import Trace
from fingertip.slip.trace_file import to_csv

Array = NDArray[np.float64]

DECIMALS = {"_v": 6, "_n": 6, "_m": 9, "_m_s": 7}
"""Of a column by the end of its name, so that the same numbers give the same bytes: 1 uV, 1 uN, 1 nm, 0.1 um/s."""
LONG_S = 15.0
"""Scenes longer than this report their progress."""


@dataclass(frozen=True, eq=False)
class Simulated:
    """What a scene gave."""

    scene: SceneFile
    seed: int
    force_n: float
    """Holding force on this finger [N]."""
    time_s: Array
    columns: dict[str, Array]
    """The outputs the scene names, in its order; slip holds booleans."""
    ran: tuple[Ran, ...]
    """The stages that ran, and what each took."""

    @property
    def trace(self) -> Trace:
        """The columns a detector is given and judged by.

        Raises
        ------
        TraceError
            If the scene does not name the voltage among its outputs.
        """
        if "voltage_v" not in self.columns:
            raise TraceError(Fault("outputs", "does not name voltage_v; a trace needs it."))
        slip = self.columns["slip"].astype(np.bool_) if "slip" in self.columns else None
        return Trace(self.time_s, self.columns["voltage_v"], self.columns.get("force_n"), slip)


def run_scene(design: Design, scene: SceneFile, seed: int = 0, say: Callable[[str], None] | None = None) -> Simulated:
    """Simulate a scene: only the stages its outputs need are run.

    Parameters
    ----------
    design
        Gives the pad's form, the board, the converter and its noise.
    scene
        What happens, and which outputs are wanted.
    seed
        Of force, surface, motors and noise. The same design, scene and seed give the same columns.
    say
        Told of progress, where a scene is long enough to need it.

    Raises
    ------
    TraceError
        If the seed is negative.
    """
    if seed < 0:
        raise TraceError(Fault("--seed", f"{seed} is negative; choose a whole number of at least 0."))
    context = Context(design, scene, seed)
    long = say and context.timeline.duration_s > LONG_S
    if say and long:
        say(f"{scene.scene}, {context.timeline.duration_s:.1f} s:")
    values, ran = run(stages_of(scene), context, scene.outputs, say if long else None)
    columns = {name: values[name] for name in scene.outputs}
    return Simulated(scene, seed, context.force_n, context.time_s[context.every], columns, tuple(ran))


def file_bytes(simulated: Simulated, path: Path) -> bytes:
    """The columns as CSV or, for a path that ends in .npz, as numpy's archive; the same numbers give the same bytes.

    Raises
    ------
    TraceError
        If the path ends otherwise.
    """
    rounded = {name: _rounded(name, values) for name, values in simulated.columns.items()}
    match path.suffix.lower():
        case ".npz":
            out = io.BytesIO()
            np.savez_compressed(out, time_s=np.round(simulated.time_s, 7), **rounded)  # type: ignore[arg-type]
            return out.getvalue()
        case ".csv":
            if list(rounded) == ["voltage_v", "force_n", "slip"]:
                return to_csv(simulated.trace)
            cells = [[f"{t:.7f}" for t in simulated.time_s.tolist()]]
            cells += [[_cell(name, value) for value in values.tolist()] for name, values in rounded.items()]
            lines = [",".join(["time_s", *rounded]), *map(",".join, zip(*cells, strict=True))]
            return ("\n".join(lines) + "\n").encode("ascii")
    raise TraceError(Fault("--out", f"{path.name!r} is no kind of trace file known here; end it in .csv or .npz."))


def _decimals(name: str) -> int:
    return next(decimals for end, decimals in reversed(DECIMALS.items()) if name.endswith(end))


def _rounded(name: str, values: Array) -> Array:
    return values if values.dtype == np.bool_ else np.round(values, _decimals(name)) + 0.0


def _cell(name: str, value: float | bool) -> str:
    return ("1" if value else "0") if isinstance(value, bool) else f"{value:.{_decimals(name)}f}"
