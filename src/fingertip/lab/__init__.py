"""Laboratory: a design's detector on simulated slips, on minutes without slip, and in studies of the article."""
