"""What happens to a sliding finger, up to the voltage that is sampled: scene, contact, vibration, sensor,
trial."""

from fingertip.sim.surfaces import SURFACES
from fingertip.sim.trial import Trial, simulate

__all__ = ["SURFACES", "Trial", "simulate"]
