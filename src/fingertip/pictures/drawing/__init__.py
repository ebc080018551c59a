"""Dimensioned drawings of the printed parts in first-angle projection, one sheet for each.

In: a design, whose B-rep solids are projected. Out: sheets of lines, texts and arrows, as SVG and
as one PDF.

>>> from fingertip.pictures.drawing.primitives import text_width
>>> round(text_width("skin", 3.5), 2)  # capitals of 3.5 mm -> mm on paper
8.67
"""
