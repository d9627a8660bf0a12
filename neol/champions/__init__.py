"""Champions after their runs: replayed, filmed, drawn, compared, exported."""
