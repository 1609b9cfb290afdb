"""``rocking bench analytic``: the kernel against other solvers, and the figures it promises."""
