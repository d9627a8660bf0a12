"""NEAT: genomes, variation, species, reproduction. Knows no environment."""
