"""Tasks of the command line and of Python: each makes one set of files of a design, checked and written whole."""
