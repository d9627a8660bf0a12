"""Style of all pictures, pictures of networks, and films of episodes."""
