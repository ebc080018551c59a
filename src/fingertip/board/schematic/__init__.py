"""The schematic: sheets as data, and KiCad's file of them."""
