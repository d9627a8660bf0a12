"""Champions of finished runs: replay, layout of their networks, export."""
