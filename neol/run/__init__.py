"""Runs: the generation loop, checkpoints, and records."""
