"""A campaign: its grid of runs, what they cost, and how far it is."""
