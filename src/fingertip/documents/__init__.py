"""Documents for people: casting sheet, acceptance, notes on the board and the firmware.

The templates of a validation stand here too; `fingertip.lab` collects their data.
"""
