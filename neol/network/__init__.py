"""What a network does: its forward pass, and how its weights learn online."""
