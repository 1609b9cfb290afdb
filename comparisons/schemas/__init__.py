"""What the commands write as JSON, as types; README.md says how their schemas are written down."""
