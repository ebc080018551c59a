"""The layout: where parts stand, the tracks that were routed, and KiCad's file of them."""
