"""Mistakes that are easily made in a script of a rocking block: each a few replacements of text in an engine's script.

An engine's record names the module of its ``MISTAKES`` (`engines.contract.Engine.mistakes`), which stands beside the
template of its script. What they cost is measured by ``rocking study mistakes``.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

from analytic.motion import SampledMotion

if TYPE_CHECKING:
    from analytic import Scene

NO_MATTER = "no matter"  # changes that look like mistakes
GROUPS = ("body", "contact", "steps", "forces", "motion", NO_MATTER)


@dataclass(frozen=True)
class Mistake:
    """A mistake, as data.

    Parameters
    ----------
    key : str
        Its name in results, a word or two.
    done : str
        What was done, as a user would say it.
    group : str
        What it concerns, one of `GROUPS`.
    replacements : dict
        {text of the script: what stands there instead}; each text occurs once.
    needs : str
        Part of a scene without which it cannot be made: "base", "bearings", "motion", or "record", a sampled motion;
        several, separated by spaces; "" for none.

    Raises
    ------
    ValueError
        The group is unknown.
    """

    key: str
    done: str
    group: str
    replacements: dict[str, str]
    needs: str = ""

    def __post_init__(self) -> None:
        if self.group not in GROUPS:
            raise ValueError(f"mistake {self.key}: group {self.group!r}; choose one of {', '.join(GROUPS)}")

    def fits(self, scene: Scene) -> bool:
        """Whether it can be made in a script of the scene."""
        sampled = isinstance(scene.motion, SampledMotion) or None
        return all((sampled if part == "record" else getattr(scene, part)) is not None for part in self.needs.split())

    def made(self, script: str) -> str:
        """The script with the mistake.

        Raises
        ------
        ValueError
            A text to be replaced does not occur exactly once.
        """
        for old, new in self.replacements.items():
            if (count := script.count(old)) != 1:
                raise ValueError(
                    f"mistake {self.key}: its text {old!r} occurs {count} times in the script, and must occur once: "
                    "take the text from the engine's template as it is now"
                )
            script = script.replace(old, new)
        return script
