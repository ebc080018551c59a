"""What happens to a finger, as strict files: sections, parameters, the timeline they make."""
