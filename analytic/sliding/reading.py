"""Dense output of a step of the march: history, forces and energy ledger (compiled)."""

from .. import layout as L
from ..compiled import inner
from ..layout import CLIMB, DRIFT, FLIGHT, SPEED, H, N
from ..polynomial import bound, largest, value
from ..readings import PROBES, integral_of_product, read_bearings, top, write_history


@inner
def read(par, contact, upright, block, step, options, into, written):
    """Write the step to history, diagnostics and ledger; returns the rows of the history written."""
    P, rows = into.P, into.history
    first, written = written, write_history(par, block, step, options.output_step, into, written)
    for k in range(first, written):
        d = min(max(rows[k, 0] - step.t, 0.0), step.h)
        rows[k, 6], rows[k, 7] = value(P[L.SLIP], step.order, d), value(P[SPEED], step.order, d)
    if options.record and step.h > 0:
        forces(par, contact, block, step, P, into.totals, into.work)
        ledger(par, upright, block, step, P, into.totals)
    return written


@inner
def forces(par, contact, block, step, P, totals, work):
    """Peak absolute base acceleration, friction demand |H|/N and least N/(m g) within the step."""
    h, order = step.h, step.order
    row, last = (L.ABSOLUTE, order) if par.on_base else (L.GROUND, step.highest)
    known = totals[L.PEAK_ACCELERATION]
    if last >= 0 and bound(P[row], last, h) > known:
        known = largest(P[row], 1.0, last, h, known, P[L.EVENT], work)
        totals[L.PEAK_ACCELERATION] = largest(P[row], -1.0, last, h, known, P[L.EVENT], work)
    if block.sigma != 0:
        totals[L.FRICTION] = contact.mu
    demand, demand_before, lift, lift_before = 0.0, 0.0, 0.0, 0.0
    for probe in range(PROBES + 1):
        across, normal = value(P[H], order, h * probe / PROBES), value(P[N], order, h * probe / PROBES)
        held = normal > 0 and block.sigma == 0 and block.mode != FLIGHT
        here, low = abs(across) / normal if held else 0.0, -normal / (par.m * par.g)
        if probe > 1:
            reached = min(top(demand_before, demand, here), contact.mu)  # where it is more, an event ends the step
            totals[L.FRICTION] = max(totals[L.FRICTION], reached)
            totals[L.NORMAL] = min(totals[L.NORMAL], -top(lift_before, lift, low))
        demand_before, demand, lift_before, lift = demand, here, lift, low


@inner
def ledger(par, upright, block, step, P, totals):
    """Work of ground, bearings and friction within the step [J]."""
    h, order, highest, momentum, part = step.h, step.order, step.highest, P[L.PRODUCT_A], P[L.PRODUCT_B]
    if highest >= 0:  # -int a_g (M x' + m drift) + a_v m climb dt
        for k in range(order + 1):
            momentum[k] = par.m * P[DRIFT, k] + (par.M * P[L.V, k] if par.on_base else 0.0)
        totals[L.INPUT] -= integral_of_product(P[L.GROUND], min(highest, order), momentum, order, h)
    if upright is not None:
        for k in range(max(highest, 0) + 1):
            part[k] = P[L.GRAVITY, k]
        part[0] -= par.g
        totals[L.INPUT] -= par.m * integral_of_product(part, max(highest, 0), P[CLIMB], order, h)
    if block.sigma != 0:
        totals[L.FRICTION_WORK] -= integral_of_product(P[H], order, P[SPEED], order, h)
    read_bearings(par, step, P, totals)
