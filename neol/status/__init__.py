"""How far a campaign is: what is done, running or failed, and what the rest will cost."""
