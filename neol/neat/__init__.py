"""NEAT: genomes, variation, breeding, species, reproduction. Knows no environment."""
