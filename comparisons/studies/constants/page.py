"""What is shown of the constants study: of each constant what moves where it is halved and doubled."""

from ...running.provenance import Result
from ...showing.parts import NAME, Column, Page, grouped, number, short, table, where
from .study import AS_IT_IS, CHANGES

# Factor from which an error is said to move, and one of CPU time, which other work on the machine changes, too.
SAID, SAID_CPU = 1.1, 1.2
LEAST = 1e-5  # of the slenderness: errors of a peak tilt below it are taken as it
MUCH = 2.0  # factor of an error that the title names
NOTHING, NOT_A_BIT, CPU = "nothing", "nothing, bit for bit", "CPU"
ERRORS = {"rms": ("e", 0.0), "peak_median": ("peak, median", LEAST), "peak_worst": ("peak, worst", LEAST)}
VALUE = Column("value", "value", digits=None)


def page(result: Result) -> Page:
    first = {NAME.of(row): row for row in where(result.rows, change=AS_IT_IS)}
    changed = grouped(where(result.rows, change=set(CHANGES)), "engine", "variant", "constant")
    shown = [_merged(rows, first[NAME.of(rows[0])]) for rows in changed.values()]
    much = [row["constant"].rpartition(":")[2].replace("_", " ") for row in shown if row["much"]]
    still = [row for row in shown if row["words"] == [NOT_A_BIT] * 2]
    return Page(
        f"The engines’ constants, halved and doubled: {' and '.join(much) or 'none'} alone "
        f"{'move' if len(much) > 1 else 'moves'} an outcome, or an error more than twofold",
        (
            "Numbers that were chosen in the engines’ tuned variants, by experience and not by a formula, each halved "
            "and doubled alone. No number was set to a scene; large effects are reported, not tuned away.",
            f"{len(still)} change no run at all, bit for bit: they concern round-off, or a limit that none of these "
            "scenes reaches.",
        ),
        more=(
            *(
                table(
                    f"{name}: error of restitution {short(first[name]['rms'])} rms, of the peak tilt "
                    f"{short(first[name]['peak_median'])} of the slenderness in the median, "
                    f"{short(first[name]['peak_worst'])} at worst; × is the factor of each",
                    rows,
                    Column("constant", lambda row: row["constant"].rpartition(":")[2]),
                    Column("where", lambda row: row["constant"].rpartition(":")[0] or "a setting"),
                    Column("what it is", "what"),
                    VALUE,
                    Column("halved: what moves", lambda row: row["words"][0]),
                    Column("doubled: what moves", lambda row: row["words"][1]),
                )
                for (name,), rows in grouped(shown, NAME.of).items()
            ),
        ),
        how=(
            f"{result.settings['scenes']} runs for each value: blocks released on rigid ground, on a base and on "
            "bearings (restitution, e); random statues under pulses that leave them upright (peak tilt); pulses 0.1 % "
            "below and above an amplitude that overturns, and the Caryatid under the synthetic motion (outcomes). "
            f"Errors are against the model. Reported is a factor beyond {SAID:g}, of CPU time beyond {SAID_CPU:g}; "
            f"an error of a peak below {short(LEAST)} is taken as that.",
        ),
        evidence=tuple(
            (
                f"{NAME.of(row)}, {row['constant']} {row['change']}: {row['failed']} of {row['runs']} runs failed",
                row["reason"],
            )
            for row in where(result.rows, part="constant")
            if row["failed"]
        ),
    )


def _merged(rows, first):
    """The rows of a constant as one: what moves where it is halved and where it is doubled."""
    factors = [_factors(row, first) for row in rows]
    errors = [max(factor, 1 / factor) for one in factors for name, factor in one.items() if name != CPU]
    return {
        **rows[0],
        "words": [_words(row, one) for row, one in zip(rows, factors, strict=True)],
        "much": any(row["outcomes_changed"] for row in rows) or max(errors, default=1.0) > MUCH,
    }


def _factors(row, first):
    """{what: factor} of the errors and the CPU time of a row over those with the constant as it is."""
    sizes = {name: [one[key] and max(one[key], least) for one in (row, first)] for key, (name, least) in ERRORS.items()}
    return {name: new / old for name, (new, old) in sizes.items() if new and old} | {CPU: row["cpu_ratio"] or 1.0}


def _words(row, factors):
    counts = {"runs fail": row["failed"], "other outcomes": row["outcomes_changed"] - row["failed"]}
    said = [f"{count} {word}" for word, count in counts.items() if count]
    for name, factor in factors.items():
        if max(factor, 1 / factor) > (SAID_CPU if name == CPU else SAID) and not row["failed"]:
            said.append(f"{name} × {number(factor, 2)}")
    return "; ".join(said) or (NOTHING if row["moved"] else NOT_A_BIT)
