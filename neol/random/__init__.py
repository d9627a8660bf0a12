"""Random streams derived from a run's seed, in Python and in compiled code."""
