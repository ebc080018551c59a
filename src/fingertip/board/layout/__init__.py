"""Board layout: placement, silkscreen, routed tracks and KiCad's board file."""
