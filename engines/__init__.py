"""The same scene in multibody engines: ``get_engine("exudyn").simulate(scene)``.

A new engine is one new file and one line here. The file holds ``simulate(scene, *, variant=None, history=True,
**settings)``, which returns a `Response`, made by `observe` (imported by that name: tests look at what it is given);
``VARIANTS``, by name a frozen dataclass of settings, the accuracy knob first; ``DEFAULT_VARIANT``; ``DECIDES``, in
words what the engine decides by itself; ``versions()``.
"""

from importlib import import_module

from analytic.errors import EngineNotInstalled

# name: (module, package that must be importable, how to install it)
ENGINES = {
    "exudyn": ("engines.exudyn_engine", "exudyn", "pip install exudyn"),
    "pybullet": ("engines.pybullet_engine", "pybullet",
                 "pip install pybullet (its wheels end at CPython 3.11: use Python 3.11)"),
    "mujoco": ("engines.mujoco_engine", "mujoco", "pip install 'rocking[mujoco]'"),
}


def get_engine(name):
    """The engine module called `name`.

    Raises
    ------
    KeyError
        The name is unknown; the message lists the known ones.
    EngineNotInstalled
        The engine's package cannot be imported; the message says how to install it.
    """
    if name not in ENGINES:
        raise KeyError(f"unknown engine {name!r}: choose one of {', '.join(ENGINES)}")
    module, package, remedy = ENGINES[name]
    try:
        import_module(package)
    except ImportError as error:
        raise EngineNotInstalled(f"engine {name!r} needs the package {package}: {remedy}") from error
    return import_module(module)


def available_engines(names=ENGINES):
    """(those of the engines `names` that are installed, {name: why it is missing} of the others).

    Raises
    ------
    ImportError
        An adapter is broken: that must not pass for a package that is absent.
    """
    present, missing = [], {}
    for name in names:
        try:
            get_engine(name)
        except EngineNotInstalled as error:
            missing[name] = str(error)
        else:
            present.append(name)
    return tuple(present), missing


def installed_engines():
    """Names of the engines that can be used here."""
    return available_engines()[0]
