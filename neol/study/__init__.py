"""The study of the paper: from a campaign's records to tables, figures and verdicts."""
