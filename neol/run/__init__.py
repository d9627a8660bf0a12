"""A run: the generation loop, its checkpoints, and the record that it leaves."""
