"""NEOL: reward-gated online plasticity for NEAT, reproduced."""
