"""From force to samples: the sensor, its bridge, the board in the time domain, the converter."""
