"""Finite elements of the pad: the elastic skin between bone and a rigid object, which checks the layer model."""
