"""The table of agreement tolerances: the bound for each engine, and the error measured when the bound was set.

The rows stand beside the engines (`engines.exudyn.tolerances`), what they measure stands here.

The verification tests assert every row, the report prints the table with the value measured anew beside it. A bound
is at most twice the `measured` worst (but for round-off); where an engine gets better, the test says so, and the
bound is to be tightened.
"""

import math
from collections.abc import Callable, Iterable
from dataclasses import dataclass, replace
from functools import partial
from typing import Any

from analytic.errors import SettingError
from engines import ENGINES, get_engine
from engines.tolerance_rows import ROUNDING

from . import agreement


@dataclass(frozen=True)
class Tolerance:
    """One row: `quantity` of an engine's variant over `scenes`, measured by `measure`, is at most `bound` [unit].

    measured: the worst found when the bound was set. round_off: the bound is what is asked for, and the measured value
    mere round-off, far below. source: what the error comes from. bound, measured: None for an engine that states no
    tolerances: what is found then neither holds nor fails.
    """

    quantity: str
    measure: Callable
    engine: str
    variant: str
    scenes: str
    bound: float | None
    unit: str
    measured: float | None
    source: str
    round_off: bool = False

    @property
    def name(self) -> str:
        return f"{self.quantity}: {self.engine}, {self.variant}, {self.scenes}"

    def found(self, runs: dict[Any, Any] | None = None) -> float:
        """The quantity measured here and now; `runs` (dict) keeps simulations that rows share.

        Raises
        ------
        Unmeasurable
            A run failed.
        EngineNotInstalled
        """
        return self.measure(self.engine, self.variant, self.scenes, {} if runs is None else runs)

    def holds(self, value: float) -> bool | None:
        """Whether a measured value lies within the bound; None without one."""
        return None if self.bound is None else value <= self.bound

    def result(self, found: float | None, failure: str | None) -> dict[str, Any]:
        """The row with what was `found`, or why nothing was, as JSON values."""
        names = "quantity", "engine", "variant", "scenes", "bound", "unit", "measured", "source"
        holds = self.holds(math.inf if found is None else found)
        return {name: getattr(self, name) for name in names} | {"found": found, "holds": holds, "failure": failure}

    def check(self, runs: dict | None = None) -> float:
        """The quantity measured here and now, asserted to hold a bound if one is stated: a test of one's own engine.

            @pytest.mark.parametrize("row", rows("exudyn"), ids=lambda row: row.name)
            def test_engine(row):
                row.check()

        Raises
        ------
        AssertionError
            It does not hold; says what was found.
        Unmeasurable, EngineNotInstalled
            As `found`.
        """
        value = self.found(runs)
        assert self.holds(value) is not False, f"{self.name}: {value:.3g} {self.unit}, tolerated {self.bound:.3g}"
        return value


# quantity: how it is measured, unit
QUANTITIES: dict[str, tuple[Callable[..., float], str]] = {
    "restitution, rms": (partial(agreement.impact_rms, "state"), "-"),
    "restitution from swings, |mean error|": (agreement.swing_restitution_bias, "-"),
    "base velocity jump, rms": (partial(agreement.impact_rms, "jump"), "relative"),
    "impact times": (agreement.impact_times, "s"),
    "peak tilt": (partial(agreement.error_of, "peak_tilt_error"), "slenderness"),
    "peak displacement": (partial(agreement.error_of, "peak_displacement_error"), "relative"),
    "tilt graph": (partial(agreement.error_of, "graph_distance"), "-"),
    "overturning time": (partial(agreement.error_of, "overturning_time_error"), "s"),
    "overturning boundary": (agreement.boundary_shift, "relative"),
    "bearing force replayed": (agreement.bearing_replay, "f0"),
    "bearing impulse in the motion": (agreement.bearing_impulse, "relative"),
    "corner lift at rest": (agreement.corner_lift, "m"),
    "base drift at rest": (agreement.base_drift, "m"),
}


def _table():
    table = []
    for engine in ENGINES.values():
        for variant, bounds in engine.tolerance_rows().items():
            for bound in bounds:
                if bound.quantity not in QUANTITIES:
                    raise SettingError(
                        f"{engine.origin or engine.name}: {bound.quantity!r} is no quantity of the "
                        f"tolerance table; choose among {', '.join(QUANTITIES)}"
                    )
                measure, unit = QUANTITIES[bound.quantity]
                table.append(
                    Tolerance(
                        bound.quantity,
                        measure,
                        engine.name,
                        variant,
                        bound.scenes,
                        bound.bound,
                        unit,
                        bound.measured,
                        bound.source,
                        round_off=bound.source == ROUNDING,
                    )
                )
    return tuple(table)


TABLE = _table()


def rows(engine: str, variant: str | None = None) -> tuple[Tolerance, ...]:
    """The rows of an engine's variant, its default one without a name.

    Of an engine that states no tolerances they are those of the first engine here, without bounds.

    Raises
    ------
    EngineNotInstalled
    SettingError
        The engine has no such variant.

    Examples
    --------
    >>> row = rows("exudyn")[0]
    >>> row.check() <= row.bound
    True
    """
    known = get_engine(engine)
    variant = variant or known.default_variant
    if variant not in known.variants:
        raise SettingError(f"{engine} has no variant {variant!r}; choose among {', '.join(known.variants)}")
    if not known.tolerance_rows():
        first = next(iter(ENGINES.values()))
        usual = rows_of(first.name, next(iter(first.tolerance_rows())))
        free: dict[str, Any] = dict(engine=engine, variant=variant, bound=None, measured=None, source="")
        return tuple(replace(row, **free) for row in usual)
    return rows_of(engine, variant)


def rows_of(engine: str, variant: str) -> tuple[Tolerance, ...]:
    """The rows of `TABLE` of an engine's variant."""
    return tuple(row for row in TABLE if (row.engine, row.variant) == (engine, variant))


def measure_all(rows: Iterable[Tolerance] = TABLE) -> list[dict[str, Any]]:
    """The table measured here and now: a list of dict, JSON values, in the order of `rows`.

    Each holds the row's columns, `found` (None where a run failed), `holds` (None without a bound), and `failure`, in
    words or None.
    """
    runs: dict[Any, Any] = {}
    results = []
    for row in rows:
        value, failure = None, None
        try:
            value = row.found(runs)
        except agreement.Unmeasurable as error:
            failure = str(error)
        results.append(row.result(value, failure))
    return results
