"""Detection of slip in recordings: files and streams, other sampling rates and noise, and warnings."""
