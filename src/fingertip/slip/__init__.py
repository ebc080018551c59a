"""Slip detection on a sampled voltage: traces, detectors, intervals. Knows nothing of the simulation."""

from fingertip.slip.chain import ChainSettings, SlipChain
from fingertip.slip.detection import Detection, detect
from fingertip.slip.intervals import Interval, Score
from fingertip.slip.read import read_trace
from fingertip.slip.registry import DETECTORS, make
from fingertip.slip.stream import Detector, Output
from fingertip.slip.trace import Trace

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
