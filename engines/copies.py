"""Near copies of a scene: runs of them show how sensitive a result is to small changes of the scene."""

from __future__ import annotations

from collections.abc import Iterator
from typing import TYPE_CHECKING

from analytic.errors import SceneError
from analytic.rocking import restitution

if TYPE_CHECKING:
    from analytic import Scene

CHANGE = 1e-4  # relative; errors of tuned engines are 1e-5 to 1e-4


def near_copies(scene: Scene) -> Iterator[Scene]:
    """The scene with its slenderness, restitution (or friction, if given), motion or start changed by +-`CHANGE`."""
    for factor in (1 + CHANGE, 1 - CHANGE):
        yield from _changed(scene, block={"slenderness": scene.block.slenderness * factor})
    yield from changed_copies(scene, CHANGE).values()


def changed_copies(scene: Scene, change: float) -> dict[str, Scene]:
    """{name: scene} with restitution (or friction, if given), motion and start changed by +-change, relative."""
    copies = {}
    e, start = restitution(scene), scene.start
    for sign, word in ((1, "up"), (-1, "down")):
        factor = 1 + sign * change
        if scene.friction is not None:  # a restitution that is given needs a corner that sticks
            copies[f"friction {word}"] = scene.with_(friction=scene.friction * factor)
        elif 0 < e * factor <= 1:
            copies[f"restitution {word}"] = scene.with_(block={"restitution": e * factor})
        if scene.motion is not None:
            copies[f"motion {word}"] = scene.with_(motion=scene.motion.scaled(factor))
        changed = {name: getattr(start, name) * factor for name in type(start).model_fields}
        if changed != start.model_dump():
            copies |= {f"start {word}": copy for copy in _changed(scene, start=changed)}
    return copies


def _changed(scene: Scene, **change: dict[str, float]) -> Iterator[Scene]:
    """The changed scene; none where the change leaves the range of a scene."""
    try:
        yield scene.with_(**change)
    except SceneError:
        return
