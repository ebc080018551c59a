"""What came of a manipulation."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

from numpy.typing import NDArray

from fingertip.arrays import Array
from fingertip.design.issues import suggest_name
from fingertip.errors import Issue, TraceError
from fingertip.sim.hand.manipulation_file import ManipulationFile
from fingertip.sim.hand.motion_plan import Plan
from fingertip.sim.stages.stage import Ran
from fingertip.slip.traces.trace import Trace


@dataclass(frozen=True, eq=False)
class Manipulated:
    """What came of it."""

    scene: ManipulationFile
    seed: int
    plan: Plan
    """Moments and forces as drawn."""
    time_s: Array
    signals: dict[str, NDArray[Any]]
    """Output -> (fingers, samples); object_m and pin_n have samples only."""
    lost_s: float | None
    """When the object left the fingers; None: it was held to the end."""
    ran: tuple[Ran, ...]
    """The stages that ran, and what each took."""

    @property
    def fingers(self) -> tuple[str, ...]:
        """The fingers, the thumb first."""
        return self.scene.fingers

    @property
    def force_n(self) -> float:
        """The thumb's force before anything happens [N]."""
        return float(self.plan.force_n[0])

    @property
    def columns(self) -> dict[str, NDArray[Any]]:
        """The outputs as columns: the thumb's and the object's by their own names, others as index_force_n."""
        found = {}
        for name in self.scene.outputs:
            signal = self.signals[name]
            found[name] = signal if signal.ndim == 1 else signal[0]
        for i, finger in list(enumerate(self.fingers))[1:]:
            shared = {f"{finger}_{name}": self.signals[name] for name in self.scene.outputs}
            found |= {name: signal[i] for name, signal in shared.items() if signal.ndim == 2}
        return found

    def trace(self, finger: str = "thumb") -> Trace:
        """What a detector is given of one finger, and judged by.

        Raises
        ------
        TraceError
            If the finger does not touch, or the scene does not name the voltage among its outputs.
        """
        if finger not in self.fingers:
            raise TraceError(Issue("finger", f"{finger!r} does not touch; {suggest_name(finger, self.fingers)}"))
        if "voltage_v" not in self.signals:
            raise TraceError(Issue("outputs", "does not name voltage_v; a trace needs it."))
        of = {name: signal[self.fingers.index(finger)] for name, signal in self.signals.items() if signal.ndim == 2}
        return Trace(self.time_s, of["voltage_v"], of.get("force_n"), of.get("slip"))
