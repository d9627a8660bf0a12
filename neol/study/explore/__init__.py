"""Parts of notebooks/explore.ipynb: choice of records, panels, pictures, small runs."""
