"""File formats: STL, 3MF and STEP for parts, JUnit XML for checks."""
