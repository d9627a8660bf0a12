"""The paper's claims, and what records say about each."""
