"""One finger from its load to samples: sensor, bridge, filter board in the time domain, comparator
and ADC.

The force on the finger over time comes in; the tactile voltage, the board's outputs and their
samples go out.

>>> from fingertip.sim.signal.grid import count_samples
>>> count_samples(duration_s=0.5, sample_rate_hz=2000.0)
1001
"""
