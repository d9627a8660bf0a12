"""NEAT: genomes, variation, breeding, species, reproduction; independent of any environment."""
