"""Dimensioned drawings of the printed parts: sheets as SVG and PDF, for whoever makes or checks the parts."""
