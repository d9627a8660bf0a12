"""A campaign: its grid of runs, the records they make, and what they cost."""
