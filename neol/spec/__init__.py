"""What a run is: its typed constants, where they come from, and its specification."""
