"""Casting of the skin: quantities to mix, hardware, tapes and print settings. The sheet is in `documents`."""
