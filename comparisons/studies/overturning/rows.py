"""The rows of the study's result, by what they are about."""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping, Sequence
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from ...running.provenance import Result

Rows = Sequence[Mapping[str, Any]]


def rows_of(result: Result, part: str, **wanted: Any) -> Rows:
    return [
        row for row in result.rows if row["part"] == part and all(row[key] == value for key, value in wanted.items())
    ]


def least_normal_of(result: Result, row: Mapping[str, Any]) -> float:
    (edge,) = rows_of(result, "edge", **{key: row[key] for key in ("ground", "shape", "frequency", "amplitude")})
    return edge["min_normal"]


def size_of(row: Mapping[str, Any]) -> int:
    return row["both_stand"] + row["both_overturn"] + row["only_a"] + row["only_b"]


def median(values: Iterable[float]) -> float:
    values = sorted(values)
    middle = len(values) // 2
    return math.nan if not values else 0.5 * (values[middle] + values[-1 - middle])
