"""The workflow: its tables and figures, and the status of a campaign."""
