"""Preparation of parts for printing: poses on the bed, plates, places of supports, and overhangs."""
