"""A bioinspired prosthetic fingertip from one file of parameters."""

from fingertip._version import __version__

__all__ = ["__version__"]
