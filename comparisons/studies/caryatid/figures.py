"""The study's figures, each drawn from a result file alone; every axis carries its unit."""

from __future__ import annotations

from typing import TYPE_CHECKING

from .curves import definitions, loops, momentum, reversal
from .histories import free_standing, isolated
from .maps import benefit, contact, seeds
from .spectra import displacement, rocking, vulnerable

if TYPE_CHECKING:
    from matplotlib.figure import Figure

    from ...running.provenance import Result
    from .canvas import Drawing


def drawings(result: Result) -> dict[str, Drawing]:
    """Name -> `Drawing` of all figures of a result file."""
    makers = {
        "paper": {"fig3": loops, "eq8": momentum, "eq12": reversal, "definitions": definitions},
        "motion": {
            "fig5a": rocking,
            "fig5b": displacement,
            "slenderness": vulnerable,
            "benefit": benefit,
            "seeds": seeds,
            "contact": contact,
        },
        "histories": {"fig4": free_standing, "fig6": isolated},
    }[result.settings["part"]]
    return {name: maker(result) for name, maker in makers.items()}


def figures(result: Result) -> dict[str, Figure]:
    """Name -> matplotlib figure of all figures of a result file."""
    return {name: drawing.figure for name, drawing in drawings(result).items()}
