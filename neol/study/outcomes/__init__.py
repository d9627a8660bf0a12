"""Numbers from records: outcomes of runs, SCORE, statistics, effects."""
