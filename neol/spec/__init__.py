"""The specification of a run: typed constants, and the files and options that set them."""
