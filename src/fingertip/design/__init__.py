"""The design: parameters, their bounds, the rules between them, and what follows from them."""

from fingertip.design.model import Design

__all__ = ["Design"]
