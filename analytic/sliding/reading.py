"""Dense output of a step of the march: history, forces and energy ledger (compiled)."""

from .. import layout as L
from ..compiled import inner
from ..polynomial import bound, largest, value
from ..readings import integral_of_product, top
from . import layout as S
from .layout import CLIMB, DRIFT, FLIGHT, SPEED, H, N

PROBES = 4


@inner
def read(par, contact, upright, block, step, options, into, written):
    """Write the step to history, diagnostics and ledger; returns the rows of the history written."""
    P, history, totals, h, order = into[0], into[4], into[5], step.h, step.order
    while written < history.shape[0] and written * options.output_step <= step.t + h:
        row, d = history[written], min(max(written * options.output_step - step.t, 0.0), h)
        row[0] = written * options.output_step
        for place, which in enumerate((L.PHI, L.W, L.X, L.V, L.F, S.SLIP, SPEED)):
            row[1 + place] = value(P[which], order, d)
        written += 1
    if not (options.record and h > 0):
        return written
    forces(par, contact, block, step, P, totals, into[1])
    ledger(par, upright, block, step, P, totals)
    return written


@inner
def forces(par, contact, block, step, P, totals, work):
    """Peak absolute base acceleration, friction demand |H|/N and least N/(m g) within the step."""
    h, order = step.h, step.order
    row, last = (L.ABSOLUTE, order) if par.on_base else (L.GROUND, step.highest)
    known = totals[S.PEAK_ACCELERATION]
    if last >= 0 and bound(P[row], last, h) > known:
        known = largest(P[row], 1.0, last, h, known, P[L.EVENT], work)
        totals[S.PEAK_ACCELERATION] = largest(P[row], -1.0, last, h, known, P[L.EVENT], work)
    if block.sigma != 0:
        totals[S.FRICTION] = contact.mu
    demand, demand_before, lift, lift_before = 0.0, 0.0, 0.0, 0.0
    for probe in range(PROBES + 1):
        across, normal = value(P[H], order, h * probe / PROBES), value(P[N], order, h * probe / PROBES)
        held = normal > 0 and block.sigma == 0 and block.mode != FLIGHT
        here, low = abs(across) / normal if held else 0.0, -normal / (par.m * par.g)
        if probe > 1:
            reached = min(top(demand_before, demand, here), contact.mu)  # where it is more, an event ends the step
            totals[S.FRICTION] = max(totals[S.FRICTION], reached)
            totals[S.NORMAL] = min(totals[S.NORMAL], -top(lift_before, lift, low))
        demand_before, demand, lift_before, lift = demand, here, lift, low


@inner
def ledger(par, upright, block, step, P, totals):
    """Work of ground, bearings and friction within the step [J]."""
    h, order, highest, momentum, part = step.h, step.order, step.highest, P[L.PRODUCT_A], P[L.PRODUCT_B]
    if highest >= 0:  # -int a_g (M x' + m drift) + a_v m climb dt
        for k in range(order + 1):
            momentum[k] = par.m * P[DRIFT, k] + (par.M * P[L.V, k] if par.on_base else 0.0)
        totals[S.INPUT] -= integral_of_product(P[L.GROUND], min(highest, order), momentum, order, h)
    if upright is not None:
        for k in range(max(highest, 0) + 1):
            part[k] = P[L.GRAVITY, k]
        part[0] -= par.g
        totals[S.INPUT] -= par.m * integral_of_product(part, max(highest, 0), P[CLIMB], order, h)
    if block.sigma != 0:
        totals[S.FRICTION_WORK] -= integral_of_product(P[H], order, P[SPEED], order, h)
    if par.count > 0:
        for k in range(order + 1):
            part[k] = P[L.F, k] - par.count * (par.kb * P[L.X, k] + par.damping * P[L.V, k])
        totals[S.HYSTERETIC] += integral_of_product(part, order, P[L.V], order, h)
        if par.damping > 0:
            totals[S.VISCOUS] += par.count * par.damping * integral_of_product(P[L.V], order, P[L.V], order, h)
