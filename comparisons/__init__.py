"""Comparisons of the engines with the analytic model: studies, results, pages, report, command line."""
