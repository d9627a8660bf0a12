"""NEOL: reward-gated online plasticity for NEAT, reproduced."""

from neol.rules import rule

__all__ = ["rule"]
