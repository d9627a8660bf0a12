"""The paper's claims, and the verdict of the records on each."""
