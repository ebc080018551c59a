"""Slip detection on a sampled voltage: traces, the article's chain, intervals. Knows nothing of the
simulation."""

from fingertip.slip.chain import ChainSettings, SlipChain
from fingertip.slip.detection import Detection, detect
from fingertip.slip.intervals import Interval, Score
from fingertip.slip.trace import Trace

__all__ = ["ChainSettings", "Detection", "Interval", "Score", "SlipChain", "Trace", "detect"]
