"""Output of a validation: tables, plots, and the page of failures and assumptions."""
