"""The studies: each asks one question of many runs and writes one result file with its figures."""
