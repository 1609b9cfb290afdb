"""What the kind says of a variant holds: only an assisted variant uses the formula of the restitution."""

import json
import os
import subprocess
import sys

from installed_package import install_fake_engine

PROGRAM = """
import hashlib, json, sys
import analytic.rocking

factor, right, impact = float(sys.argv[1]), analytic.rocking.momentum_restitution, analytic.rocking.RockingModel.impact
# before an adapter is imported
analytic.rocking.momentum_restitution = lambda scene: factor * right(scene)
analytic.rocking.RockingModel.impact = lambda self, *rates: tuple(factor * value for value in impact(self, *rates))

from analytic import Base, Bearings, Block, PulseMotion, Scene, Start
from engines import get_engine, installed_engines

block = Block(mass=3172.05, radius=1.0884, slenderness=0.3)
bearings = Bearings(count=4, ka=6.22e4, kb=6.22e3, alpha=44.69, damping=300.0)
pulse = PulseMotion("one-sine", 6.0, 6.0)
scenes = [
    Scene(block=block, start=Start(tilt=0.15), duration=1.5),
    Scene(block=block, base=Base(mass=212.0), start=Start(tilt=0.15), duration=1.5),
    Scene(block=block, base=Base(mass=900.0), bearings=bearings, motion=pulse, duration=1.5),
]
found = {}
for name in installed_engines():
    engine = get_engine(name)
    for variant, kind in engine.variants.items():
        digest = hashlib.sha256()
        for scene in scenes:
            trace = engine.run(scene, variant, kind.settings).trace
            for column in (*trace.COLUMNS, "centre"):
                values = getattr(trace, column)
                digest.update(b"" if values is None else values.tobytes())
        found[f"{name}, {variant}"] = kind.kind, digest.hexdigest()
print(json.dumps(found))
"""


def traces(factor, folder):
    """{variant: (kind, digest of its traces)} with the formula of the restitution times `factor`; packages in `folder`
    are installed, too."""
    path = os.pathsep.join([str(folder), *filter(None, [os.environ.get("PYTHONPATH")])])
    done = subprocess.run(
        [sys.executable, "-c", PROGRAM, str(factor)],
        capture_output=True,
        text=True,
        timeout=600,
        env={**os.environ, "PYTHONPATH": path},
    )
    assert done.returncode == 0, done.stderr
    return json.loads(done.stdout.splitlines()[-1])


def test_only_assisted_variants_use_the_formula_of_the_restitution(tmp_path):
    """Of the engines here none; the fake one does, which shows that its use is seen."""
    install_fake_engine(tmp_path)
    right, wrong = traces(1.0, tmp_path), traces(0.8, tmp_path)
    assert right.keys() == wrong.keys()
    assisted = {name for name, (kind, _) in right.items() if kind == "assisted"}
    assert {name for name in right if right[name] != wrong[name]} == assisted == {"crude, euler"}
