"""``rocking script``: a scene as a stand-alone script in plain calls of an engine."""

from pathlib import Path
from typing import Annotated

import typer

SUFFIX = ".py"


def command(
    engine: Annotated[str, typer.Argument(help="An engine that has a script.")],
    scene: Annotated[str, typer.Argument(help="Scene file (TOML), or the name of a shipped scene.")],
    output: Annotated[str | None, typer.Option(metavar="FILE", help="The script; by default SCENE-ENGINE.py.")] = None,
) -> None:
    """Write a Python script that builds this scene in the plain engine and runs it, without this project.

    It is the engine's tuned variant, for readers who want to build on it. A record is written beside it.

    Example: rocking script pybullet caryatid-isolated --output caryatid.py
    """
    from analytic.errors import SettingError
    from analytic.scene_file import load_scene
    from engines import BROKEN, ENGINES
    from engines.couple import unkept_friction
    from engines.scripting import write_script

    from ..running.files import check_writable, write_text
    from ..running.progress import compile_kernels
    from ..running.solving import in_file
    from ..showing.terminal import echo

    if engine in BROKEN:
        raise BROKEN[engine]
    able = [name for name, one in ENGINES.items() if one.script]
    if engine not in able:
        raise SettingError(f"{engine}: no engine with a script; choose one of {', '.join(able)}")
    if output is not None and Path(output).suffix != SUFFIX:
        raise SettingError(f"--output {output}: end the name in {SUFFIX}")
    what = load_scene(scene)
    if what.duration is None or what.friction is not None:  # the model is run
        compile_kernels()
    with in_file(scene):
        files = write_script(ENGINES[engine], what, Path(output).stem if output else None)
    folder = Path(output).parent if output else Path()
    places = {str(folder / file): text for file, text in files.items()}
    check_writable(places, inputs=[scene])
    for place, text in places.items():
        write_text(place, text)
    echo(*(f"{place} written" for place in places), *filter(None, [unkept_friction(what)]))
