"""Record files as tests write them, and where the recorded motions lie, whose terms do not allow shipping them."""

from pathlib import Path

import numpy as np
import pytest

from analytic.errors import SceneError
from analytic.records import read_record

RECORDS = Path(__file__).parents[2] / "shared" / "records"
FORMATS = RECORDS / "formats"
needs_records = pytest.mark.skipif(not FORMATS.is_dir(), reason="the recorded motions are not here (../shared/records)")


def write(folder, content, name="record"):
    """The path of a file of this text, or of these bytes."""
    path = folder / name
    path.write_bytes(content.encode() if isinstance(content, str) else content)
    return path


def assert_refused(path, words, **said):
    """A record is refused in one message that begins with its file and says the words; **said: as `read_record`."""
    with pytest.raises(SceneError) as caught:
        read_record(path, **said)
    assert str(caught.value).startswith(f"{path}: ") and words in str(caught.value)


def pairs(folder, count, seconds=3.0, dt=0.005):
    """The folder with so many records in it, each of two components: noise that dies out, made up."""
    steps = round(seconds / dt)
    for number in range(count):
        for place, component in enumerate("EN"):
            noise = np.random.default_rng([number, place]).normal(size=steps) * np.linspace(1, 0, steps)
            rows = [f"{dt * k:.3f},{value:.5f}" for k, value in enumerate(noise)]
            write(folder, "time [s],acc [m/s2]\n" + "\n".join(rows) + "\n", f"made{number}_{component}.csv")
    return folder
