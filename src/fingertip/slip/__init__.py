"""Slip detection on a sampled voltage: traces, detectors, intervals. Knows nothing of the simulation."""

from fingertip.slip.detection import Detection, detect
from fingertip.slip.detectors.chain import ChainSettings, SlipChain
from fingertip.slip.detectors.registry import DETECTORS, make
from fingertip.slip.detectors.stream import Detector, Output
from fingertip.slip.intervals import Interval, Score
from fingertip.slip.traces.read import read_trace
from fingertip.slip.traces.trace import Trace

__all__ = [
    "DETECTORS",
    "ChainSettings",
    "Detection",
    "Detector",
    "Interval",
    "Output",
    "Score",
    "SlipChain",
    "Trace",
    "detect",
    "make",
    "read_trace",
]
