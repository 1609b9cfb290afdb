"""Scene files as owners of statues write them: a slender bronze near its edge, a bust on bearings."""

BRONZE = """
[block]
mass = 739.2
radius = 0.61612
slenderness = 0.22923
[motion]
synthetic = "duzce-like"
scale = {scale}
"""
BUST = """# my own words
name = "bust"
[block]
mass = 1551.83
radius = 0.989002
slenderness = 0.281772
[base]
mass = 400.0
{bearings}
[motion]  # and these
synthetic = "duzce-like"
"""
CLIFF = 0.62  # scale of the bronze's motion at which it falls, and does not at .9 % less
