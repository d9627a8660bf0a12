"""What the workflow makes: every table and figure, and how far a campaign is."""
