"""Report on a sweep: summary, plots and best design, and its rows as CSV.

The rows of a database come in. Limiting rules, sensitivities, the Pareto front and the files that
show them go out.

>>> import numpy as np
>>> from fingertip.sweep.report.best_design_file import find_pareto_front
>>> find_pareto_front(np.array([[1.0, 3.0], [2.0, 2.0], [3.0, 3.0]])).tolist()
[0, 1]
"""
