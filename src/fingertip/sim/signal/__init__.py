"""One finger from its load to samples: sensor, bridge, filter board in the time domain, comparator and ADC."""
