"""Electronics from force to samples: sensor, bridge, filter board in the time domain, comparator and ADC."""
