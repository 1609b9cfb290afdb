"""Packed records: read as what they hold, or refused; damaged ones never read as something else."""

import gzip
import io
import random
import zipfile

import numpy as np
import pytest
from made_up_records import VALUES, cosmos, csmip
from mutated_files import damaged_bytes
from record_files import assert_refused, write
from undamaged_records import records

from analytic.errors import SceneError
from analytic.records import content, read_record

AT2 = "a\nb\nACCELERATION IN UNITS OF G\nNPTS= 4, DT= .01 SEC\n.1 .2 -.3 .4\n"


def zipped(files, method=zipfile.ZIP_DEFLATED):
    """A zip file of {name: text}; a name that ends in / is a folder."""
    packed = io.BytesIO()
    with zipfile.ZipFile(packed, "w", method) as archive:
        for file in files.items():
            archive.writestr(*file)
    return packed.getvalue()


SOUND = [record[:3] for record in records() if "refused" not in record[0]]


@pytest.mark.parametrize("name, text, said", SOUND, ids=[name for name, *_ in SOUND])
def test_packed_is_read_as_plain(tmp_path, name, text, said):
    plain = read_record(write(tmp_path, text.encode(), "plain"), **said)
    for packed in (gzip.compress(text.encode()), zipped({"folder/": "", "folder/x.dat": text, "__MACOSX/x": "-"})):
        motion = read_record(write(tmp_path, packed), **said)
        np.testing.assert_array_equal(motion.samples, plain.samples)
        assert motion.dt == plain.dt and motion.label.startswith("record")


def locked():
    """A zip file that says that it has a password."""
    packed = bytearray(zipped({"a": AT2}))
    for magic, place in ((b"PK\x03\x04", 6), (b"PK\x01\x02", 8)):
        packed[packed.index(magic) + place] |= 1
    return bytes(packed)


BAD = {
    "gzip cut": (gzip.compress(AT2.encode())[:-9], "is a damaged gzip file"),
    "zip cut": (zipped({"a": AT2})[:-30], "is a damaged zip file"),
    "several": (zipped({f"{n}.AT2": AT2 for n in "abcdefg"}), "holds 7 files: a.AT2, b.AT2, c.AT2, d.AT2, e.AT2, ...;"),
    "none": (zipped({}), "is packed by zip, and empty"),
    "folder alone": (zipped({"a/": ""}), "holds 0 files"),
    "password": (locked(), "is a zip file with a password; unpack it first"),
    "twice": (gzip.compress(zipped({"a": AT2})), "is packed by zip; unpack it once, it is packed twice (unzip)"),
    "bzip2": (b"BZh91AY&SY", "is packed by bzip2; unpack it first (bunzip2)"),
    "velocities": (zipped({"a.VT2": AT2}), "holds velocities, as .VT2 files do"),
    "velocities by the name without .gz": (gzip.compress(AT2.encode()), "holds velocities, as .VT2 files do"),
    "Excel": (
        zipped({"[Content_Types].xml": "", "xl/workbook.xml": ""}),
        "record: is a spreadsheet; save the sheet with the record as CSV",
    ),
    "nothing in it": (zipped({"a": ""}), "record: is empty"),
}


@pytest.mark.parametrize("packed, message", BAD.values(), ids=BAD)
def test_refused(tmp_path, packed, message):
    assert_refused(write(tmp_path, packed, "record.VT2.gz"), message)


@pytest.mark.parametrize("pack", [gzip.compress, lambda text: zipped({"a": text})])
def test_no_more_is_unpacked_than_a_record_can_hold(tmp_path, monkeypatch, pack):
    monkeypatch.setattr(content, "LARGEST", 100_000)
    assert_refused(write(tmp_path, pack(bytes(10_000_000))), "unpacks to more than 0.1 MB")


PACKED = [
    (pack(text.encode()), said)
    for text, said in ((AT2, {}), (csmip(VALUES), {"channel": 2}), (cosmos(VALUES), {"channel": 1}))
    for pack in (gzip.compress, lambda text: zipped({"a": text}), lambda text: zipped({"a": text}, zipfile.ZIP_STORED))
]


@pytest.mark.slow
def test_damaged_packed_files_are_refused_or_read_the_same(tmp_path):
    chance, read = random.Random(0), 0
    for packed, said in PACKED:
        whole = read_record(write(tmp_path, packed), **said)
        for _ in range(100):
            path = write(tmp_path, damaged_bytes(packed, chance))
            try:
                motion = read_record(path, "g" if chance.random() < 0.1 else None, **said)
            except SceneError as error:
                assert str(error).isprintable() and error.remedy
                continue
            assert motion.dt == whole.dt and motion.samples.tolist() == whole.samples.tolist()
            read += 1
    assert 0 < read < 450
