"""What a validation shows: tables, pictures, and what failed."""
