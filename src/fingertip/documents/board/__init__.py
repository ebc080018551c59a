"""Documents of a board: README of its folder, bring-up sheet, and the files of a divider.

A design and its figures come in; Markdown goes out, whose text stands in templates beside the
modules.

>>> from fingertip import Design
>>> from fingertip.documents.board.divider import describe_readings, list_readings
>>> describe_readings(list_readings(Design.load("first_finger")))[0]
'untouched: 0.00 V (0.00 to 0.10), 0 counts'
"""
