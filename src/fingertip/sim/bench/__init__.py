"""Error against run time: our integrators and other people's on the same problems. Needs scipy; ngspice if there."""
