"""What all others stand on: errors, files, compiled kernels, signals."""
