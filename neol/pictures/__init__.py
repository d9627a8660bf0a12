"""How pictures look, and pictures of networks and films of episodes."""
