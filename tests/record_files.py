"""Record files as tests write them, and where the recorded motions lie, whose terms do not allow shipping them."""

from pathlib import Path

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
