"""A campaign: its grid of runs, their records, and their cost."""
