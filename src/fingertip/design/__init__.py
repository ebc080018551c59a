"""Design of a fingertip: parameters, their bounds, the rules between them, and the geometry derived from them."""

from fingertip.design.model import Design

__all__ = ["Design"]
