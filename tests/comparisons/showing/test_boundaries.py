"""What is said of overturning boundaries."""

from types import SimpleNamespace

from comparisons.showing.boundaries import under_jumps


def test_a_largest_shift_under_a_jump_is_said():
    rows = [
        {"part": "edge", "ground": "g", "shape": shape, "frequency": 2.0, "amplitude": 3.0, "min_normal": 0.5}
        for shape in ("one-sine", "one-cosine")
    ]
    for engine, shifts in (("exudyn", (1e-4, -2e-3)), ("pybullet", (2e-4, 1e-4))):
        for edge, shift in zip(tuple(rows[:2]), shifts, strict=True):
            rows.append({**edge, "part": "shift", "engine": engine, "variant": "v", "shift": shift})
    settings = {"default_variants": {"exudyn": "v", "pybullet": "v"}}
    assert list(under_jumps(SimpleNamespace(rows=rows, settings=settings))) == [
        "The shift is largest where the acceleration of the ground jumps at the start: −0.20 % under a one-cosine "
        "pulse (exudyn)."
    ]
