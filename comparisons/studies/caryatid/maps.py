"""Maps over slenderness and intensity: who stays upright, and what the contact asks for."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from matplotlib.colors import BoundaryNorm, ListedColormap
from matplotlib.patches import Patch

from .canvas import BLACK, BLUE, PURPLE, RED, SKY, Drawing, axes_of
from .paper import X_MAX
from .runs import FREE, ISOLATED
from .variations import CATEGORIES, FRICTION_LIMITS, ONLY_FREE, ONLY_ISOLATED

if TYPE_CHECKING:
    from ...running.provenance import Result

CATEGORY_COLOURS = ("#FFFFFF", SKY, RED, "#999999")


def benefit(result: Result) -> Drawing:
    """Who stays upright, over slenderness and intensity."""
    figure, axis = axes_of(height=4.2)
    arrays = result.arrays
    gamma, intensity = arrays["benefit/slenderness"], arrays["benefit/intensity"]
    axis.pcolormesh(
        gamma,
        intensity,
        arrays["benefit/category"].T,
        cmap=ListedColormap(CATEGORY_COLOURS),
        norm=BoundaryNorm(np.arange(-0.5, 4), 4),
        rasterized=True,
    )
    axis.contour(
        gamma, intensity, arrays["benefit/isolated displacement"].T, levels=[X_MAX], colors=BLACK, linestyles="--"
    )
    axis.contour(gamma, intensity, arrays["benefit/isolated lifts"].T.astype(float), levels=[0.5], colors=BLUE)
    axis.plot(result.settings["slenderness"], 1.0, "*", color=PURPLE, markersize=14)
    handles = [
        Patch(facecolor=colour, edgecolor="0.4", label=text)
        for colour, text in zip(CATEGORY_COLOURS, CATEGORIES, strict=True)
    ]
    handles += axis.plot([], [], "--", color=BLACK, label="isolated: 0.30 m reached")
    handles += axis.plot([], [], "-", color=BLUE, label="isolated: lifts above")
    handles += axis.plot([], [], "*", color=PURPLE, linestyle="", markersize=10, label="the Caryatid")
    axis.set(xlabel="slenderness γ [rad]", ylabel="intensity: motion times [-]")
    figure.legend(handles=handles, loc="outside lower center", ncols=2, fontsize=8)
    return Drawing(
        figure,
        "Map of who stays upright: " + "; ".join(CATEGORIES) + ".",
        f"Does isolation help? {result.settings['motion']['label']}. Above the dashed line the bearings "
        "would need more than their 0.30 m: what the law says there is no design.",
    )


def seeds(result: Result) -> Drawing:
    """Share of the synthetic motions in which isolation helps, and in which it harms."""
    figure, axes = axes_of(1, 2, height=3.4, sharey=True)
    arrays = result.arrays
    total = arrays["seeds/counts"].sum(axis=0).max()
    for axis, kind, title in ((axes[0], ONLY_ISOLATED, "isolation helps"), (axes[1], ONLY_FREE, "isolation harms")):
        mesh = axis.pcolormesh(
            arrays["seeds/slenderness"],
            arrays["seeds/intensity"],
            100.0 * arrays["seeds/counts"][kind].T / total,
            cmap="cividis",
            vmin=0,
            vmax=100,
            rasterized=True,
        )
        axis.set(title=title, xlabel="slenderness γ [rad]")
    axes[0].set_ylabel("intensity: motion times [-]")
    figure.colorbar(mesh, ax=axes, label="synthetic motions [%]")
    return Drawing(
        figure,
        "Two maps: share of synthetic motions in which only the isolated block stays upright, and "
        "in which only the free-standing one does.",
        f"{total} synthetic motions: where only the isolated block stays upright (left), and where only "
        "the free-standing one does (right).",
    )


def contact(result: Result) -> Drawing:
    """Friction demand and least normal force."""
    figure, axes = axes_of(2, 2, height=5.4, sharex=True, sharey=True)
    arrays = result.arrays
    gamma, intensity = arrays["contact/slenderness"], arrays["contact/intensity"]
    bounds = (0, 0.1, 0.2, *FRICTION_LIMITS, 1.0)
    for column, name in enumerate((FREE, ISOLATED)):
        friction = np.minimum(arrays[f"contact/{name} friction"], 1e3)
        top = axes[0, column].pcolormesh(
            gamma, intensity, friction.T, cmap="cividis", rasterized=True, norm=BoundaryNorm(bounds, 256, extend="max")
        )
        low = axes[1, column].pcolormesh(
            gamma,
            intensity,
            np.maximum(arrays[f"contact/{name} normal"], -1.0).T,
            cmap="cividis",
            vmin=0,
            vmax=1,
            rasterized=True,
        )
        upright = arrays[f"contact/{name} upright"].T.astype(float)
        for axis in axes[:, column]:
            if 0 < upright.mean() < 1:
                axis.contour(gamma, intensity, upright, levels=[0.5], colors="white", linewidths=1.2)
        axes[0, column].set_title(name)
        axes[1, column].set_xlabel("slenderness γ [rad]")
    for row in (0, 1):
        axes[row, 0].set_ylabel("intensity [-]")
    figure.colorbar(top, ax=axes[0, :], label="friction demand |H|/N [-]")
    figure.colorbar(low, ax=axes[1, :], label="least N/(m g) [-]", extend="min")
    return Drawing(
        figure,
        "Maps of friction demand and least normal force, free-standing and isolated.",
        "What 'no sliding, no jump' asks for; overturning runs up to their unstable point. White line: "
        "beyond it the block overturns.",
    )
