"""The study of the paper: tables, figures and verdicts from a campaign's records."""
