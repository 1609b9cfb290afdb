"""The studies: the same scene in the analytic model and in the engines, compared; command line and report."""
