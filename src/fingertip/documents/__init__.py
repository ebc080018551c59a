"""Documents for people: casting sheet, acceptance, notes on the board, the firmware and the fit coupon.

The templates of a validation stand here too; `fingertip.lab` collects their data.
"""
