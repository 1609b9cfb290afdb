"""A statue on a free pedestal: two rigid blocks on each other that lift, rock and land, and do not slide."""
