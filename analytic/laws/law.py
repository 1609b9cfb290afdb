"""Protocol of a bearing law: the hysteretic part z of the force f = kb x + z + c v of one bearing.

A law is one file of this folder with one `Law`. The last argument of its functions is the record c of its constants:
dk = ka - kb [N/m], f0 [N], and the law's own. s is the sign of the velocity, 0 at rest.

|z| never exceeds f0, and |dz/dx| never dk: solvers take them as bounds of force and stiffness. f0 = 0 says that the law
has no z. A law gets z and the travel dx, not the displacement x: an elastic one needs x as a function of z.
"""

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any, Protocol

import numpy as np

from ..kernel.compiled import inner
from ..kernel.polynomial import value

Constants = Any  # `laws.Constants`, with the constants of all laws


class Given(Protocol):
    """The numbers of [bearings] from which a law is made, see `scene.Bearings`."""

    ka: float

    def given(self, name: str) -> float: ...


@inner
def no_mark(s: float, z: float, c: Constants) -> float:
    return 1.0


@inner
def no_power(travel: float, c: Constants) -> float:
    return 0.0


@inner
def last_of_series(s: float, z: float, q: np.ndarray, order: int, h: float, power: float, c: Constants) -> float:
    return value(q, order, h)


@dataclass(frozen=True)
class Law:
    """One bearing law. Fields with a default are needed by some laws only.

    A law is symmetric: z(-x) = -z(x). ``begin`` is also called from Python, by its ``py_func``, so it calls
    nothing that is `inner`. The ``constant_names`` differ from the fields of the kernel's `Parameters`.

    name : name in scene files.
    needs, ignores : keys of [bearings] beside ka that are required, and that may be there unused; others are errors.
    constant_names : names of its own constants, beside dk and f0.
    constants(bearings) : dict of kb, dk, f0 and its own constants.
    memory : whether every reversal of the base is an event, as where z depends on the path.
    after_travel(z, dx, c) : z after monotonic travel dx [m].
    work(z, dx, c) : integral of z over that travel [J]; not compiled.
    recoverable(z, c) : energy [J] that a bearing with z > 0 returns while unloading to z = 0.
    power(travel, c) : what the end of a step and the start of the next both need of the travel, slow to compute.
    begin(s, z, travel, power, c) : (q_0, factors, corner) at the start of a Taylor step: q_0, three numbers for the
        terms, and the next s z at which the stiffness jumps, an event; inf without one.
    term(k, factors, x, v, q) : z_k for k >= 1, with q_k filled in; x up to k, v and q up to k - 1 are given.
    mark(s, z, c) : position of z on the branch of direction s [m], stored at a reversal; travel is counted from it.
    reached(s, z, q, order, h, power, c) : z at the end of a step.
    branch(z, direction, c) : function (z, v) -> z' [N/s] from z to the next reversal or corner. If given, the second
        implementation integrates z as a state, otherwise it uses `after_travel`; not compiled.
    """

    name: str
    needs: tuple[str, ...]
    constants: Callable[[Given], dict[str, float]]
    after_travel: Callable
    work: Callable
    recoverable: Callable
    begin: Any
    term: Callable
    constant_names: tuple[str, ...] = ()
    ignores: tuple[str, ...] = ()
    memory: bool = True
    mark: Callable = no_mark
    power: Callable = no_power
    reached: Callable = last_of_series
    branch: Callable | None = None
