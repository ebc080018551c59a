"""Extreme and stiff cases of every compute kernel: held, refused with a reason, or wrong."""
