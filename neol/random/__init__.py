"""From a run's seed to every random stream, in Python and in compiled code."""
