"""The scenes drawn to scale: block, base, bearings and the symbols of the equations."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Any

from matplotlib.figure import Figure
from matplotlib.patches import Arc, Polygon, Rectangle

from .parts import figure_of

if TYPE_CHECKING:
    from .parts import Figure as Picture

STONE, STEEL, RUBBER, LINE, FAINT = "#e9e2d0", "#c7cdd3", "#4a4a4a", "#1a1a1a", "#8a8a8a"
SLAB, RUBBER_HEIGHT = 0.16, 0.20  # m, of base and bearings as drawn
TILT = 0.6  # of the outline that shows phi, over slenderness


def draw_scenes(scenes: Sequence[Mapping[str, Any]]) -> Picture:
    """Figure of scenes as in the settings of ``caryatid.json``: a list of dicts, side by side."""
    figure = Figure(figsize=(5.4, 3.9), layout="constrained")
    for axis, scene in zip(figure.subplots(1, len(scenes), sharey=True, squeeze=False)[0], scenes, strict=True):
        _draw(axis, scene)
    words = "; ".join(
        f"{scene['name']}: a slender block of mass {scene['block']['mass']:g} kg, {2 * scene['half_width']:.3f} m wide "
        f"and {2 * scene['half_height']:.3f} m high, "
        + (
            f"on a base of {scene['base']['mass']:g} kg carried by {scene['bearings']['count']} bearings"
            if scene["bearings"]
            else "on rigid ground"
        )
        for scene in scenes
    )
    return figure_of(
        figure,
        f"Two scenes drawn to scale. {words}.",
        "The scenes, block to scale. φ: tilt, positive toward +x; γ: slenderness; R: base corner to "
        "centre of mass; x: base displacement relative to the ground; a_g: ground acceleration. The "
        "dashed outline is a tilted position.",
    )


def _draw(axis, scene):
    b, h, gamma = scene["half_width"], scene["half_height"], scene["block"]["slenderness"]
    floor = 0.0
    if scene["base"]:
        floor = SLAB + RUBBER_HEIGHT
        _draw_base(axis, b, floor)
    axis.add_patch(Rectangle((-1.2, -0.12), 2.4, 0.12, facecolor="white", edgecolor=FAINT, hatch="////", linewidth=0))
    axis.plot([-1.2, 1.2], [0, 0], color=LINE, linewidth=1.4)
    axis.add_patch(Rectangle((-b, floor), 2 * b, 2 * h, facecolor=STONE, edgecolor=LINE, linewidth=1.4))
    axis.add_patch(
        Polygon(
            [_turned(x, y, b, TILT * gamma, floor) for x, y in ((-b, 0), (b, 0), (b, 2 * h), (-b, 2 * h))],
            fill=False,
            edgecolor=FAINT,
            linestyle="--",
        )
    )
    # R from the right corner to the centre of mass, gamma between R and the vertical
    axis.plot([b, 0], [floor, floor + h], color=LINE, linewidth=1)
    axis.plot(0, floor + h, "o", color=LINE, markersize=4)
    axis.plot([b, b], [floor, floor + 0.95 * h], color=LINE, linewidth=0.7, linestyle=":")
    axis.add_patch(Arc((b, floor), 1.1 * h, 1.1 * h, theta1=90, theta2=90 + math.degrees(gamma), color=LINE))
    axis.text(0.02 * h, floor + 0.42 * h, "R", ha="right", style="italic")
    axis.text(b - 0.30 * h * math.sin(gamma), floor + 0.61 * h, "γ", ha="center", style="italic")
    axis.text(-0.05, floor + 1.08 * h, "m", ha="right", style="italic")
    top = _turned(b, 2 * h, b, TILT * gamma, floor)
    axis.annotate(
        "",
        top,
        (b, floor + 2 * h),
        arrowprops={"arrowstyle": "->", "connectionstyle": "arc3,rad=-.2", "shrinkA": 0, "shrinkB": 0},
    )
    axis.text((b + top[0]) / 2, floor + 2 * h + 0.09, "φ", ha="center", style="italic")
    axis.annotate("", (-0.65, -0.28), (-1.15, -0.28), arrowprops={"arrowstyle": "->"})
    axis.text(-0.58, -0.28, "$a_g$, $+x$", va="center")
    axis.set(xlim=(-1.25, 1.25), ylim=(-0.42, 2.85), aspect="equal")
    axis.set_title("isolated" if scene["base"] else "free-standing", fontsize=11)
    axis.axis("off")


def _draw_base(axis, b, floor):
    wide = b + 0.4
    axis.add_patch(Rectangle((-wide, RUBBER_HEIGHT), 2 * wide, SLAB, facecolor=STEEL, edgecolor=LINE, linewidth=1.2))
    axis.text(-wide + 0.05, RUBBER_HEIGHT + SLAB / 2, "$m_b$", va="center")
    for middle in (-0.65 * wide, 0.65 * wide):  # two of the bearings are behind the others
        for layer in range(5):
            shade = RUBBER if layer % 2 == 0 else STEEL
            axis.add_patch(
                Rectangle(
                    (middle - 0.13, layer * RUBBER_HEIGHT / 5),
                    0.26,
                    RUBBER_HEIGHT / 5,
                    facecolor=shade,
                    edgecolor=LINE,
                    linewidth=0.5,
                )
            )
    axis.annotate("", (wide + 0.32, floor - SLAB / 2), (wide + 0.02, floor - SLAB / 2), arrowprops={"arrowstyle": "->"})
    axis.text(wide + 0.2, floor - SLAB / 2 + 0.06, "x", ha="center", style="italic")


def _turned(x, y, b, tilt, floor):
    """A point of the block (from the middle of its foot) after tipping about its right corner."""
    dx, c, s = x - b, math.cos(tilt), math.sin(tilt)
    return b + c * dx + s * y, floor - s * dx + c * y
