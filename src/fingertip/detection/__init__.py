"""Detection of slip in files, arrays and streams, with warnings about the result.

The detector of a design is adapted to the sampling rate and to the noise of the recording.

>>> import numpy as np
>>> from fingertip.detection.recordings import detect
>>> detect(np.full(500, 1.0), rate_hz=2000.0)
Detection(digital: 0 intervals ON)
"""
