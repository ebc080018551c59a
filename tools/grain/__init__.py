"""Report for a review: how dense the code is, and how much there is of it, beside the last release.

It is read, and refuses nothing: no figure of it has a limit.
"""


class GrainError(Exception):
    """A sentence that says why there is no report, and what to do about it."""
