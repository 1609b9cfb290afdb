"""The problem sheet for codes that are not ours: scenes stated as equations and numbers, and answers scored.

`problems` holds the scenes and what is asked of each, `pages` puts them into words, `variants` solves them here and
computes what known mistakes would give, `score` reads a file of answers and compares.
"""
