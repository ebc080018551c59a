"""Documents for people: casting sheet, acceptance, notes on the board, the firmware and the fit coupon."""
