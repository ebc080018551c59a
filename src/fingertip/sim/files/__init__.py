"""Files that describe a simulation: one schema, with the tables of a scene and those of a manipulation."""
