"""The paper's figures, and figures beyond the paper's."""
