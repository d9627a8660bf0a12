"""How tables and figures are written: captions, LaTeX, sidecars."""
