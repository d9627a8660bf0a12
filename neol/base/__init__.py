"""Foundations of all other folders: errors, files, compiled kernels, signals."""
