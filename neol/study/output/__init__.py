"""Output of tables and figures: captions, LaTeX, sidecars."""
