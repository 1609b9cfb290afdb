"""Contrast of two colours, as the guidelines of accessibility (WCAG) have it."""


def _luminance(colour):
    parts = (part / 255 for part in colour[:3])
    linear = (part / 12.92 if part <= 0.03928 else ((part + 0.055) / 1.055) ** 2.4 for part in parts)
    return sum(weight * part for weight, part in zip((0.2126, 0.7152, 0.0722), linear, strict=True))


def contrast(one, other):
    """1 to 21, of colours as (red, green, blue), 0 to 255."""
    low, high = sorted(map(_luminance, (one, other)))
    return (high + 0.05) / (low + 0.05)
