"""The detectors, behind one face."""
