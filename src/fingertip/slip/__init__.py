"""Slip detection on a sampled voltage: traces, detectors and intervals, independent of the simulation.

Each name is imported when it is first used, so that the names of the detectors are known without numpy.
"""

from importlib import import_module
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from fingertip.slip.detection import Detection, detect
    from fingertip.slip.detectors.analog_and_digital import ChainSettings, SlipChain
    from fingertip.slip.detectors.registry import DETECTORS, Detector, DetectorOutput, make_detector
    from fingertip.slip.traces.read import read_trace
    from fingertip.slip.traces.trace import Trace
    from fingertip.slip.traces.truth import Interval, Score

_MODULES = {
    "DETECTORS": "detectors.registry",
    "ChainSettings": "detectors.analog_and_digital",
    "Detection": "detection",
    "Detector": "detectors.registry",
    "DetectorOutput": "detectors.registry",
    "Interval": "traces.truth",
    "Score": "traces.truth",
    "SlipChain": "detectors.analog_and_digital",
    "Trace": "traces.trace",
    "detect": "detection",
    "make_detector": "detectors.registry",
    "read_trace": "traces.read",
}
"""Public name -> module that defines it."""
__all__ = [
    "DETECTORS",
    "ChainSettings",
    "Detection",
    "Detector",
    "DetectorOutput",
    "Interval",
    "Score",
    "SlipChain",
    "Trace",
    "detect",
    "make_detector",
    "read_trace",
]


def __getattr__(name: str) -> Any:
    if name not in _MODULES:
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    return getattr(import_module(f"{__name__}.{_MODULES[name]}"), name)
