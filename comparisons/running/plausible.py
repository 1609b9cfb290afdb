"""Implausible numbers in a new scene: centimetres for metres, an impossible density, a tilt past the balance, bearings
that do not yield."""

import math
import sys
from collections.abc import Sequence

import typer

from analytic.errors import SettingError
from analytic.new_scene import MATERIALS, UPLIFT, YIELD, derived
from analytic.scene import Scene
from engines.statue_range import RANGE

# Of the lightest material: walls of a tenth of the width fill a third of a hollow piece, and a figure half of its box.
HOLLOW = 1 / 6


def doubts(
    scene: Scene, height: float, width: float, depth: float | None = None, *, weighed: bool, designed: bool
) -> list[str]:
    """Implausible values: the options, their value, the plausible range and the remedy; empty if there are none.

    Parameters
    ----------
    scene : Scene
        Made from the options.
    height, width, depth : float
        Of the block [m]; the depth is the width where it is not given.
    weighed : bool
        The block's mass was given, not its density.
    designed : bool
        The bearings were given by their period, not by their constants.
    """
    block, found = scene.block, []
    sizes = f"--height {height:g} and --width {width:g}"
    least, most, _ = RANGE["radius"]  # the engines' variants are tested for it, and nothing is promised beyond
    if not least <= block.radius <= most:  # what else follows from the lengths is wrong with them
        return [
            f"{sizes} give a radius R of {block.radius:.3g} m, a statue has {least:g} to {most:g} m; "
            f"give them in m{_meant(height, width)}"
        ]
    least, most, _ = RANGE["slenderness"]  # likewise; stockier blocks slide or stand, more slender ones fall at once
    if not least <= block.slenderness <= most:
        found.append(
            f"{sizes} give a slenderness of {block.slenderness:.3g} rad, a statue has {least:g} to {most:g} rad: "
            f"a width of {math.tan(least):.2g} to {math.tan(most):.2g} of the height; "
            + ("exchange them" if least <= math.pi / 2 - block.slenderness <= most else "correct one")
        )
    if depth is not None and depth > 2 * RANGE["radius"][1]:  # a side of the largest statue is 2 R at most
        found.append(
            f"--depth {depth:g} is longer than any side of a statue, {2 * RANGE['radius'][1]:g} m; give it in m"
        )
    tilt = scene.start.tilt
    if scene.motion is None and not 0 < abs(tilt) < block.slenderness:
        what = "releases the block where it stands: nothing moves" if tilt == 0 else "is beyond its balance: it falls"
        found.append(f"--tilt {tilt:g} {what}; give a size between 0 and the slenderness, {block.slenderness:.4g} rad")
    density = block.mass / (height * width * (depth or width))
    least, most = HOLLOW * min(MATERIALS.values()), max(MATERIALS.values())  # the densest one, solid
    if not least <= density <= most:
        given = f"--mass {block.mass:g} makes a block of" if weighed else "--density is"
        remedy = "give the mass in kg, or the block's --depth in m" if weighed else "give it in kg/m3"
        found.append(
            f"{given} {density:.3g} kg/m3, a statue has {least:g} (hollow wood) to {most:g} (bronze); {remedy}"
        )
    values = {name: value for name, value, _ in derived(scene)}
    if values.get(YIELD, 0.0) >= values[UPLIFT]:  # until they yield they are stiff, and the block is lifted before that
        given = "--period, --damping and --xmax" if designed else "--ka, --kb and --alpha"
        remedy = (
            "give a longer --period, a lower --damping or a smaller --xmax"
            if designed
            else "give a lower --ka or a higher --alpha"
        )
        found.append(
            f"{given} give bearings that yield at {values[YIELD]:.3g} m/s2, and so do not isolate before the block "
            f"lifts at {values[UPLIFT]:.3g} m/s2: they should yield below that; {remedy}"
        )
    return found


def _meant(height: float, width: float) -> str:
    """A question for the lengths of a statue of which one or both were given in cm or mm."""
    guesses = []
    for unit, scale in (("cm", 100), ("mm", 1000)):
        for high, wide in ((height / scale, width / scale), (height / scale, width), (height, width / scale)):
            sizes = {"radius": math.hypot(high, wide) / 2, "slenderness": math.atan2(wide, high)}
            if all(RANGE[name][0] <= size <= RANGE[name][1] for name, size in sizes.items()):
                guesses.append(f"--height {high:g} --width {wide:g} (from {unit})")
    return f"; did you mean {' or '.join(guesses)}?" if guesses else ""


def confirm(found: Sequence[str]) -> None:
    """Return if nothing was found, or if the user confirms the values in a terminal.

    Raises
    ------
    SettingError
        There is no terminal, or the answer is no.
    """
    if not found:
        return
    words = "; ".join(found)
    if not sys.stdin.isatty():
        raise SettingError(f"{words} (--anyway writes the file as it is)")
    if not typer.confirm(f"{words}\nWrite it anyway?", err=True):
        raise SettingError("nothing was written; correct the options named")
