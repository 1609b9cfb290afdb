"""Readers of recorded ground acceleration: PEER AT2, ESM/DYNA 1.2 ASCII, two columns."""

import math
import re
from decimal import Decimal
from pathlib import Path

import numpy as np

from .errors import SceneError
from .motion import SampledMotion

G = 9.81  # m/s2: the g of a record in g is the g of the default scene
UNITS = {"m/s2": 1.0, "cm/s2": 0.01, "g": G}  # -> m/s2

# Fortran writes ".1E-02", "1D-3", and "-.1E-02-.2E-02" where a sign fills the column: exponents have two digits.
NUMBER = re.compile(r"[+-]?(?:\d+\.?\d*|\.\d+)(?:[EeDd][+-]?\d{1,2})?")
AT2_COUNT = (re.compile(rf"NPTS\s*=\s*(\S+?)\s*,?\s*DT\s*=\s*({NUMBER.pattern}|\S+)", re.I),
             re.compile(rf"^\s*(\d+)[\s,]+({NUMBER.pattern})[\s,]*NPTS[\s,]+DT", re.I))
DYNA_KEY = re.compile(r"([A-Z][A-Z0-9_/^]*):(.*)")
AT2_HEADER_LINES = 8  # the NPTS line is the fourth in every known variant


def read_record(path, units=None, scale=1.0):
    """The ground motion in a record file; the format is recognised from the content.

    Parameters
    ----------
    path : str or Path
        PEER AT2, ESM/DYNA 1.2 ASCII (also as AFAD writes it) or two columns (time [s], acceleration).
    units : {"m/s2", "cm/s2", "g"}, optional
        Unit of a two-column record, which carries none; not allowed for the others, which do.
    scale : float
        Factor on the accelerations.

    Returns
    -------
    SampledMotion
        In m/s2; its time counts from the first sample.

    Raises
    ------
    SceneError
        Names the file, the line or header key, what was found and the remedy.
    """
    path = Path(path)
    try:
        text = path.read_bytes().decode("utf-8-sig", errors="replace")
    except OSError as error:
        raise SceneError("motion.record", str(path), f"cannot be read ({error.strerror})",
                         "give the path of a record, relative to the scene file") from error
    # CR CR LF is what a DOS text becomes after one more conversion; Ctrl-Z ended DOS files.
    lines = re.sub(r"\r*\n|\r", "\n", text.replace("\x1a", "")).split("\n")
    try:
        dt, samples = _read(lines, units)
        if len(samples) < 2:
            raise SceneError("record", None, f"holds {len(samples)} samples", "give at least two accelerations")
        label = path.name if scale == 1 else f"{path.name} x {scale:g}"
        return SampledMotion(dt, samples * scale, label)
    except SceneError as error:
        raise error.in_file(path) from None


def _read(lines, units):
    """(dt [s], accelerations [m/s2]) in whichever format the lines are."""
    if units is not None and units not in UNITS:
        raise SceneError("motion.units", units, "not a known unit", "choose one of " + ", ".join(UNITS))
    first = next((line for line in lines if line.strip()), None)
    if first is None:
        raise SceneError("record", None, "is empty", "give a record with at least two accelerations")
    read = None
    if any(pattern.search(line) for line in lines[:AT2_HEADER_LINES] for pattern in AT2_COUNT):
        read = _read_at2
    elif DYNA_KEY.match(first):
        read = _read_dyna
    if read is not None:
        if units is not None:
            raise SceneError("motion.units", units, "this record carries its own unit", "remove units")
        return read(lines)
    first_data = next((line for line in lines if line.split("#")[0].strip()), first)
    if not re.match(r"\s*([+-]?[.\d]|nan|[+-]?inf)", first_data, re.I):
        raise SceneError("line 1", first.strip()[:60], "not a known record format",
                         "give PEER AT2 (a line NPTS= ..., DT= ...), ESM/DYNA 1.2 ASCII or two columns of numbers")
    return _read_columns(lines, units)


def _read_at2(lines):
    head, match = next((i, found) for i, line in enumerate(lines[:AT2_HEADER_LINES])
                       for pattern in AT2_COUNT if (found := pattern.search(line)))
    dt = _interval(f"line {head + 1}, DT", match[2])
    for number, line in enumerate(lines[:head], 1):
        stated = re.search(r"UNITS OF\s+([^\s.,;]+)", line, re.I)
        if stated and stated[1].upper() != "G":
            raise SceneError(f"line {number}, UNITS OF", stated[1], "not an acceleration in g",
                             "give the acceleration file (.AT2) of this record")
    samples = _numbers(lines, head + 1)
    _check_count(f"line {head + 1}, NPTS", match[1], samples)
    return dt, samples * G


def _read_dyna(lines):
    header, line = {}, 0
    while line < len(lines) and (match := DYNA_KEY.match(lines[line])):
        header[match[1]] = match[2].strip()
        line += 1
    for key in ("SAMPLING_INTERVAL_S", "UNITS"):
        if not header.get(key):
            raise SceneError(key, None, "missing from the header", "give a complete ESM/DYNA 1.2 ASCII file")
    unit = header["UNITS"].replace("^", "").lower()
    if unit not in UNITS:
        raise SceneError("UNITS", header["UNITS"], "not an acceleration this reader knows",
                         "give the acceleration file, in cm/s^2")
    samples = _numbers(lines, line)
    if header.get("NDATA"):
        _check_count("NDATA", header["NDATA"], samples)
    return _interval("SAMPLING_INTERVAL_S", header["SAMPLING_INTERVAL_S"]), samples * UNITS[unit]


def _read_columns(lines, units):
    rows, tokens = [], []
    for number, line in enumerate(lines, 1):
        parts = line.split("#")[0].replace(",", " ").split()
        if not parts:
            continue
        if len(parts) != 2:
            raise SceneError(f"line {number}", line.strip()[:60], f"holds {len(parts)} columns",
                             "write time [s] and acceleration, two numbers a line")
        rows.append([_number(f"line {number}", part) for part in parts])
        tokens.append(parts[0])
    if units is None:
        raise SceneError("motion.units", None, "missing; two columns carry no unit",
                         "add units, one of " + ", ".join(UNITS))
    table = np.array(rows)
    times = table[:, 0]
    accelerations = table[:, 1] * UNITS[units]
    if len(times) < 2:
        return 1.0, accelerations  # refused by the caller
    dt = float(f"{(times[-1] - times[0]) / (len(times) - 1):.12g}")
    # Times may be rounded as printed, but not leave the grid by more than that, or by 2 % of the step.
    printed = max(10.0 ** Decimal(token.upper().replace("D", "E")).as_tuple().exponent for token in tokens[:100])
    allowed = min(printed, 0.02 * abs(dt)) + 1e-9 * np.abs(times).max()
    off = np.abs(times - times[0] - dt * np.arange(len(times))) > allowed
    if dt <= 0 or off.any() or (np.diff(times) <= 0).any():
        steps = np.diff(times)
        usual = float(np.median(steps))
        worst = int(np.abs(steps - usual).argmax()) + 1
        raise SceneError(f"sample {worst + 1}, time", float(times[worst]),
                         f"the sampling is not uniform: this step is {steps[worst - 1]:.6g} s, most are {usual:.6g} s",
                         "resample the record at equal intervals")
    return dt, accelerations


def _numbers(lines, begin):
    """All numbers [as printed] from line `begin` on, shape (n,)."""
    values = []
    for number, line in enumerate(lines[begin:], begin + 1):
        if NUMBER.sub("", line).strip():
            wrong = next(part for part in line.split() if NUMBER.sub("", part))
            _number(f"line {number}", wrong)
            raise SceneError(f"line {number}", wrong, "not a number", "mend or remove it")
        values += [float(token.upper().replace("D", "E")) for token in NUMBER.findall(line)]
    return np.array(values)


def _number(where, token):
    remedy = "mend or remove it"
    try:
        value = float(token.upper().replace("D", "E"))
    except ValueError:
        raise SceneError(where, token, "not a number", remedy) from None
    if not math.isfinite(value):
        raise SceneError(where, token, "not finite", remedy)
    return value


def _interval(where, token):
    """Sampling interval [s]."""
    value = _number(where, token)
    if value <= 0:
        raise SceneError(where, value, "not a sampling interval", "give a step above 0 s")
    return value


def _check_count(where, stated, samples):
    if not stated.isdigit():
        raise SceneError(where, stated, "not a number of samples", "give a whole number")
    if int(stated) != len(samples):
        raise SceneError(where, int(stated), f"but {len(samples)} samples follow",
                         "the file is cut or damaged: fetch it again")
