"""What notebooks/explore.ipynb plays with: records to choose from, panels, pictures, small runs."""
