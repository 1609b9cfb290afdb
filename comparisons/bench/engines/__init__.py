"""``rocking bench engines``: an engine against the analytic model on random scenes of a wide box."""
