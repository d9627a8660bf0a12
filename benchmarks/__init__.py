"""Speed of the engines, their physics and a peer, measured in one interleaved run."""
