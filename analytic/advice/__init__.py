"""Advice on a scene: margins, bearings, what it stands on, and the odds under uncertain values."""
