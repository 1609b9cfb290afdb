"""What the judgement keeps of an analytic run, as it stands in JSON."""

from comparisons.measuring.kept import keep

from analytic import Base, Block, Scene, Start, simulate
from comparisons.running.cases import Case
from comparisons.running.provenance import json_ready

FREE = Scene(
    block=Block(mass=10.0, radius=1.0, slenderness=0.25), base=Base(mass=5.0), start=Start(tilt=0.15), duration=4.0
)


def kept(scene, **options):
    return json_ready(keep(Case(scene), simulate(scene, **options)))
