"""``rocking bench``: what solvers cost at what error; the kernel against others here, the engines in `engines`."""
