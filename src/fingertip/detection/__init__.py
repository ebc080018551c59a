"""Detection of slip in recordings: a file, an array or a stream comes in, and slip goes out, with
warnings.

The detector of a design is adapted to the sampling rate and to the noise of the recording.

>>> import numpy as np
>>> from fingertip.detection.recordings import detect
>>> detect(np.full(500, 1.0), rate_hz=2000.0)
Detection(digital: 0 intervals ON)
"""
