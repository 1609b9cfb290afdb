"""The problem sheet for other codes: scenes stated as equations and numbers, and scores of answers.

`problems` holds the scenes and what is asked of each, `pages` puts them into words, `variants` solves them here and
computes what known mistakes would give, `score` reads a file of answers and compares.
"""
