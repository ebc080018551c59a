"""Slip detection on a sampled voltage: traces, detectors and intervals, independent of the simulation."""

from fingertip.slip.detection import Detection, detect
from fingertip.slip.detectors.detector import Detector, DetectorOutput
from fingertip.slip.detectors.digital import ChainSettings, SlipChain
from fingertip.slip.detectors.registry import DETECTORS, make_detector
from fingertip.slip.traces.intervals import Interval, Score
from fingertip.slip.traces.read import read_trace
from fingertip.slip.traces.trace import Trace

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
