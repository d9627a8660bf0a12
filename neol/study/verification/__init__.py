"""Whether records are what they say: their manifests, their checks, replays of their runs."""
