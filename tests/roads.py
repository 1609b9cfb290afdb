"""Kinds of scenes that a user may have, each as short as its kind allows; and what the commands must do on each."""

import math

from lying_engine import noise

G = 9.81
BLOCK = "[block]\nmass = 400.0\nradius = 1.0\nslenderness = {gamma}\n"
BASE = "[base]\nmass = 200.0\n"
BEARINGS = '[bearings]\nlaw = "{law}"\ncount = 4\nka = {ka}\n'
LINEAR = BASE + BEARINGS.format(law="linear", ka=2000.0)
# of .5 m and a friction of .1, as `rocking new --pendulum-radius` writes them: 1471.5 N on each
PENDULUM = BASE + BEARINGS.format(law="bilinear", ka=150093.0) + "kb = 2943.0\nyield_force = 150.093\nx_max = 0.3\n"
LAWS = {
    "linear": LINEAR,
    "algebraic": BASE + BEARINGS.format(law="algebraic", ka=2e4) + "kb = 2e3\nalpha = 40.0\n",
    "bouc-wen": BASE + BEARINGS.format(law="bouc-wen", ka=2e4) + "kb = 2e3\nalpha = 40.0\ndamping = 50.0\n",
    "bilinear": BASE + BEARINGS.format(law="bilinear", ka=2e4) + "kb = 2e3\nyield_force = 200.0\n",
}


def scene(support="", motion="", *, gamma=0.25, friction=None, block="", more=""):
    """The text of a scene file."""
    first = f"friction = {friction}\n" if friction is not None else ""
    return f"{first}{BLOCK.format(gamma=gamma)}{block}{support}{motion}{more}"


def pulse(amplitude, frequency=6.0, shape="one-sine", vertical=None):
    """vertical : amplitude of the vertical pulse over that of the horizontal one."""
    up = "" if vertical is None else f"vertical_ratio = {vertical}\n"
    return f'[motion]\npulse = "{shape}"\namplitude = {amplitude}\nfrequency = {frequency}\n{up}'


def start(tilt):
    return f"[start]\ntilt = {tilt}\n"


PEDESTAL = "[pedestal]\nwidth = 0.6\n"
STURDY = "[pedestal]\nwidth = 1.2\nmass = 300.0\nheight = 0.2\n"
TALL = "[pedestal]\nwidth = 0.5\nmass = 300.0\nheight = 1.0\n"
RECORD = '[motion]\nrecord = "records/plain.csv"\n'
# {kind: (scene file, outcome)}
KINDS = {
    "stands": (scene(motion=pulse(1.0)), "stands"),
    "rocks": (scene(motion=pulse(3.2, 8.0)), "rocks"),
    "overturns": (scene(motion=pulse(9.0, 4.0)), "overturns"),
    "overturns after an impact": (scene(motion=pulse(4.0)), "overturns"),
    "slender": (scene(gamma=0.1, more=start(0.06)), "rocks"),
    "released": (scene(more=start(0.15)), "rocks"),
    "beyond its balance": (scene(more=start(0.3)), "overturns"),
    **{f"on {law} bearings": (scene(bearings, pulse(4.0, 9.0)), "rocks") for law, bearings in LAWS.items()},
    "on a base without bearings": (scene(BASE, pulse(3.0)), "stands"),
    "overturns on bearings": (scene(LINEAR, pulse(8.0)), "overturns"),
    "slides": (scene(motion=pulse(3.0), friction=0.15), "slides"),
    "slides on bearings": (scene(LINEAR, pulse(3.0), friction=0.1), "slides"),
    "slide-rocks": (scene(motion=pulse(9.0, 14.0), gamma=0.3, friction=0.33), "rocks"),
    "flies": (scene(motion=pulse(4.0, 12.0, vertical=4.0), friction=0.6), "rocks"),
    "falls and slides": (scene(motion=pulse(9.0, 4.0), friction=0.5), "overturns"),
    "slips off": (scene(motion=pulse(5.0, 2.5), friction=0.1), "slides"),
    "falls off": (scene(PEDESTAL, pulse(5.0, 2.5), friction=0.1), "falls off"),
    "pedestal that stays": (scene(LINEAR + STURDY, pulse(3.0, 9.0)), "stands"),
    "pedestal that may lift": (scene(TALL, pulse(3.2, 8.0)), "rocks"),
    "flies without a friction": (scene(motion=pulse(4.0, 12.0, vertical=4.0)), "overturns"),
    "vertical motion": (scene(motion=pulse(3.2, 8.0, vertical=0.6)), "rocks"),
    "vertical motion of 1 g on bearings": (scene(LINEAR, pulse(3.0, 9.0, vertical=G / 3.0)), "overturns"),
    "given restitution": (scene(block="restitution = 0.7\n", more=start(0.15)), "rocks"),
    "given restitution and friction": (
        scene(motion=pulse(3.2, 8.0), block="restitution = 0.85\n", friction=0.9),
        "rocks",
    ),
    "record": (scene(LINEAR, RECORD), "stands"),
    "beyond x_max": (scene(LINEAR + "x_max = 0.02\n", pulse(1.0, 9.0)), "stands"),
    "quiet": (scene(motion=pulse(0.1)), "stands"),
    "quiet on bearings": (scene(LINEAR, pulse(0.1)), "stands"),
    "loud": (scene(motion=pulse(80.0, 12.0)), "overturns"),
    "outside the range": (scene(gamma=0.04, motion=pulse(0.45, 9.0)), "rocks"),
    "undecided": (scene(motion=pulse(4.0), more="[run]\nduration = 0.7\n"), "rocks"),
    "a copy is refused": (scene(friction=0.15, more=start(0.26)), "overturns"),
    "free-standing it is refused": (scene(LINEAR, friction=0.185, more=start(0.2)), "rocks"),
    "on pendulum bearings": (scene(PENDULUM, pulse(4.0, 9.0)), "rocks"),
}
# {kind: (field, part of the problem)}: the model refuses the scene itself
FREE = "[pedestal]\nwidth = 0.8\nmass = 900.0\nheight = 1.5\nfree = true\n"
ISOLATED = FREE + LAWS["algebraic"].replace("mass = 200.0", "mass = 500.0")
TWO_SECONDS = "[run]\nduration = 2.0\n"  # without the bounces that follow, which take a second of CPU time
# {kind: (scene file of a statue on a free pedestal, outcome)}
STACKS = {
    "stack stands": (scene(FREE, pulse(1.0)), "stands"),
    "stack rocks": (scene(FREE, pulse(3.2, 8.0), more=TWO_SECONDS), "rocks"),
    "statue overturns": (scene(FREE, pulse(4.0)), "overturns"),
    "pedestal overturns": (scene(FREE.replace("width = 0.8", "width = 0.5"), pulse(3.0, 2.0)), "pedestal overturns"),
    "stack that parts": (scene(FREE, pulse(8.0), gamma=0.3), "failed"),
    "stack on bearings": (scene(ISOLATED, pulse(4.0, 9.0)), "stands"),
    "stack released": (scene(FREE, more=start(0.15) + TWO_SECONDS), "rocks"),
}
REFUSED = {
    "refused by its friction": (scene(friction=0.05, more=start(0.2)), "friction"),
    "refused by its restitution": (
        scene(motion=pulse(9.0, 8.0), block="restitution = 0.5\n", friction=0.3),
        "block.restitution",
    ),
}


def write_records(folder):
    """Three records, one with a vertical channel, one of them twice; a file that is none, and two that look like no
    earthquake."""
    folder.mkdir()

    def rows(values, step=0.02):
        return "".join(f"{k * step:.2f},{value:.6f}\n" for k, value in enumerate(values))

    values = noise(100, 1)
    head = "time [s],acceleration [m/s2]\n"
    (folder / "plain.csv").write_text(head + rows(3.0 * values))
    (folder / "same.csv").write_text(head + rows(3.0 * values))
    both = (f"{k * 0.02:.2f},{12.0 * value:.6f},{4.0 * value:.6f}\n" for k, value in enumerate(noise(120, 2)))
    (folder / "strong.csv").write_text("time [s],E [m/s2],Up [m/s2]\n" + "".join(both))
    (folder / "bare.txt").write_text("".join(f"{k * 0.02:.2f} {value:.6f}\n" for k, value in enumerate(0.2 * values)))
    (folder / "gal.txt").write_text("".join(f"{k * 0.02:.2f} {value:.6f}\n" for k, value in enumerate(60 * values)))
    (folder / "spectrum.txt").write_text(
        "".join(f"{0.02 * k:.2f} {abs(math.sin(0.3 * k)) + 0.01:.6f}\n" for k in range(1, 100))
    )
    (folder / "notes.txt").write_text("words\n")
