"""Messages that name a command's options instead of the parameters or keys behind them."""

from __future__ import annotations

import contextlib
import re
from collections.abc import Iterator, Mapping

from analytic.errors import SceneError, SettingError

# What `rocking new` and `rocking design` share; those of a record, wherever one is read.
DEFINITION = "Of the damping. equivalent: W_D/(4 pi E_s), the usual one; paper: W_D/(2 pi E_s), twice as much."
RATIO = "By design: ka/kb; Table 1(b) of the paper has 10."
RECORD_OPTIONS = {f"motion.{name}": f"--{name}" for name in ("units", "dt", "column", "channel")}
_SAME = ("height", "width", "depth", "density", "mass", "period", "damping", "definition", "count", "friction")
OPTIONS = {
    **{name: f"--{name}" for name in _SAME},
    **{f"bearings.{name}": f"--{name}" for name in ("count", "ka", "kb", "alpha")},
    **RECORD_OPTIONS,
    **{"x_max": "--xmax", "bearings.x_max": "--xmax", "stiffness_ratio": "--ratio", "start.tilt": "--tilt"},
    **{"block.mass": "--mass", "base.mass": "--base-mass"},
}


@contextlib.contextmanager
def named_by_options(options: Mapping[str, str]) -> Iterator[None]:
    """Errors raised inside name options; options : {parameter of a function, or key of a scene: option}."""
    try:
        yield
    except SettingError as error:
        words = str(error)
        for name, option in options.items():
            end = r"\b" if "_" in name else "(?= = )"  # a word of a sentence stays one
            words = re.sub(rf"(?<![\w.-]){re.escape(name)}{end}", option, words)
        raise SettingError(words) from None
    except SceneError as error:
        raise _by_options(error, options) from None


def _by_options(error: SceneError, options: Mapping[str, str]) -> SceneError:
    """The same mistakes, naming options."""
    key = options.get(error.key, error.key)
    of_a_file = key == error.key or error.key in RECORD_OPTIONS
    file = error.file if of_a_file else None  # other options name no file
    others = tuple(_by_options(other, options) for other in error.others)
    return SceneError(key, error.value, error.problem, error.remedy, file, others)
