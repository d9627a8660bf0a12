"""Networks: the forward pass, and online learning of the weights."""
