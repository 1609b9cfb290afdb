"""The problem sheet for other codes: scenes stated as equations and numbers, with reference answers.

`problems` holds the scenes, what is asked of each and the answers; `pages` puts them into words.
"""
