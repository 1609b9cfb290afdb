"""Recorded motions: does an engine overturn the blocks that the analytic model overturns?"""
