"""Foundation that knows no finger: errors, files and sets of files, workers, progress, numerics,
compiled loops.

Paths, numbers and functions of the other folders come in; files that appear whole or not at all,
and errors with a remedy, go out.

>>> from fingertip.foundation.files import round_for_output
>>> round_for_output(0.1 + 0.2)
0.3
"""
