"""Finite elements of the pad: an elastic skin between rigid bone and a rigid object. They check the fast layer model."""
