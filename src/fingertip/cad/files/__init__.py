"""Parts as files: STL, 3MF, STEP; checks as JUnit XML; parts for other libraries."""
