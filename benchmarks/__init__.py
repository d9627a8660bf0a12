"""Speed: the engines, the physics they stand on, and a peer, measured in one interleaved run."""
