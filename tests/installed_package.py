"""Packages as pip leaves them, in a folder for sys.path: modules beside a ``.dist-info`` that declares entry points."""

from pathlib import Path

FAKE_ENGINE = (Path(__file__).parent / "fake_engine.py").read_text()


def install(folder, distribution, entries, group="rocking.engines", **modules):
    """Write a distribution into `folder`.

    Parameters
    ----------
    folder : Path
    distribution : str
    entries : dict
        {name: "module:attribute"} of the entry point `group`.
    **modules
        Source text by name.
    """
    for name, source in modules.items():
        (folder / f"{name}.py").write_text(source)
    info = folder / f"{distribution.replace('-', '_')}-0.1.dist-info"
    info.mkdir()
    (info / "METADATA").write_text(f"Metadata-Version: 2.1\nName: {distribution}\nVersion: 0.1\n")
    lines = [f"[{group}]", *(f"{name} = {value}" for name, value in entries.items())]
    (info / "entry_points.txt").write_text("\n".join(lines) + "\n")
    return folder


def install_fake_engine(folder):
    """The fake engine "crude" of the distribution crude-engine."""
    return install(folder, "crude-engine", {"crude": "crude_engine:ENGINE"}, crude_engine=FAKE_ENGINE)
