"""Scene files with one mistake each, and the message it must give: for the reader and for the command line."""

SCENE = """\
name = "test"
gravity = 9.81
[block]
mass = 3172.05
radius = 1.0884
slenderness = 0.28
[base]
mass = 212.0
[bearings]
law = "algebraic"
count = 4
ka = 6.22e4
kb = 6.22e3
alpha = 44.69
[motion]
synthetic = "duzce-like"
[start]
tilt = 0.0
[run]
duration = 20.0
"""

RECORDS = {
    "two.txt": "0 1\n0.01 2\n0.02 1\n",
    "uneven.txt": "0 1\n0.01 2\n0.03 1\n0.04 2\n",
    "nan.txt": "0 1\n0.01 nan\n0.02 1\n",
    "empty.AT2": "",
    "none.AT2": "a\nb\nACCELERATION IN UNITS OF G\nNPTS= 0, DT= .01 SEC\n",
    "short.AT2": "a\nb\nACCELERATION IN UNITS OF G\nNPTS= 3, DT= .01 SEC\n.1 .2\n",
    "good.AT2": "a\nb\nACCELERATION IN UNITS OF G\nNPTS= 2, DT= .01 SEC\n.1 .2\n",
    "odd.dat": "what is this\n",
}


def write_scene(folder, text):
    """The text as scene.toml in `folder`, the records beside it; returns the path."""
    for name, record in RECORDS.items():
        (folder / name).write_text(record)
    path = folder / "scene.toml"
    path.write_text(text)
    return path


def replaced(old, new):
    def change(text):
        assert text.count(old) >= 1, old
        return text.replace(old, new, 1)

    return change


def motion(lines):
    return replaced('synthetic = "duzce-like"', lines)


ONE_OF = "give exactly one of record, pulse and synthetic"
BAD = {
    # unknown
    "misspelt key": (
        replaced("slenderness", "slendernes"),
        "block.slendernes = 0.28: unknown key; write slenderness if that is meant, else remove it, known are mass,",
    ),
    "unknown key": (
        replaced("mass = 212.0", "mass = 212.0\nheight = 2"),
        "base.height = 2: unknown key; remove it, known are mass",
    ),
    "unknown table": (replaced("[run]", "[runs]"), "runs = {'duration': 20.0}: unknown key; write run"),
    "unknown law": (
        replaced("algebraic", "cubic"),
        "bearings.law = 'cubic': not known; choose 'algebraic', 'bilinear', 'bouc-wen' or 'linear'",
    ),
    "unused key of another law": (
        replaced("kb = 6.22e3", "kb = 6.22e3\nyield_force = 700.0"),
        "bearings.yield_force = 700.0: not used by the algebraic law; remove it",
    ),
    "law without its yield force": (
        replaced(
            '"algebraic"\ncount = 4\nka = 6.22e4\nkb = 6.22e3\nalpha = 44.69', '"bilinear"\nka = 6.22e4\nkb = 6.22e3'
        ),
        "bearings.yield_force: missing; add it: the bilinear law needs it",
    ),
    "unknown pulse": (
        motion('pulse = "two-sine"\namplitude = 1\nfrequency = 1'),
        "motion.pulse = 'two-sine': not known; choose 'one-sine', 'one-cosine', 'half-sine', 'rectangular' or 'ricker'",
    ),
    "unknown synthetic": (motion('synthetic = "kobe"'), "motion.synthetic = 'kobe': not known; choose 'duzce-like'"),
    "unknown units": (
        motion('record = "two.txt"\nunits = "inch"'),
        "motion.units = 'inch': not known; choose 'm/s2', 'cm/s2', 'g', 'gal'",
    ),
    "key called self": (lambda text: "self = 1\n" + text, "self = 1: unknown key"),
    # missing
    "no mass": (replaced("mass = 3172.05\n", ""), "block.mass: missing; add mass = ... [kg]"),
    "no block": (
        replaced("[block]\nmass = 3172.05\nradius = 1.0884\nslenderness = 0.28\n", ""),
        "block: missing; add a table [block]",
    ),
    "no base mass": (replaced("mass = 212.0\n", ""), "base.mass: missing; add mass = ... [kg]"),
    "no alpha": (replaced("alpha = 44.69\n", ""), "bearings.alpha: missing; add it: the algebraic law needs it"),
    "no width": (
        replaced("[bearings]", "[pedestal]\nmass = 430.0\nheight = 1.0\n[bearings]"),
        "pedestal.width: missing; add width = ... [m]",
    ),
    "no height": (
        replaced("[bearings]", "[pedestal]\nwidth = 1.0\nmass = 430.0\n[bearings]"),
        "pedestal.height: missing; give mass and height, or neither",
    ),
    "pedestal narrower than its block": (
        replaced("[bearings]", "[pedestal]\nwidth = 0.6\n[bearings]"),
        "pedestal.width = 0.6: narrower than the block; give at least 0.601571 m",
    ),
    "no kb": (replaced("kb = 6.22e3\n", ""), "bearings.kb: missing; add it: the algebraic law needs it"),
    "no amplitude": (
        motion('pulse = "one-sine"\nfrequency = 2'),
        "motion.amplitude: missing; add amplitude = ... [m/s2]",
    ),
    "no frequency": (
        motion('pulse = "one-sine"\namplitude = 2'),
        "motion.frequency: missing; add frequency = ... [rad/s]",
    ),
    "no units": (
        motion('record = "two.txt"'),
        "motion.units: missing; columns of numbers carry no unit (two.txt); add units, one of m/s2, cm/s2, g",
    ),
    # wrong type
    "text for number": (replaced("3172.05", '"heavy"'), "block.mass = 'heavy': wrong type (str); give a number [kg]"),
    "truth for number": (replaced("1.0884", "true"), "block.radius = True: wrong type (bool); give a number [m]"),
    "list for number": (
        replaced("0.28", "[0.28]"),
        "block.slenderness = [0.28]: wrong type (list); give a number [rad]",
    ),
    "fraction of a bearing": (
        replaced("count = 4", "count = 4.5"),
        "bearings.count = 4.5: wrong type (float); give a whole number",
    ),
    "number for text": (replaced('name = "test"', "name = 3"), 'name = 3: wrong type (int); give text in "quotes"'),
    "number for table": (
        lambda text: "base = 212.0\n" + text.replace("[base]\nmass = 212.0\n", ""),
        "base = 212.0: wrong type (float); give a table: write [base]",
    ),
    "text for seed": (
        motion('synthetic = "duzce-like"\nseed = "a"'),
        "motion.seed = 'a': wrong type (str); give a whole number",
    ),
    "list of blocks": (
        replaced("[block]", "[[block]]"),
        "block = [{'mass': 3172.05, 'radius': 1.0884, 'slenderness': 0.28}]: wrong type (list); "
        "give a table: write [block]",
    ),
    # out of range
    "negative mass": (replaced("3172.05", "-1.0"), "block.mass = -1.0: out of range; give a number above 0 [kg]"),
    "no radius at all": (replaced("1.0884", "0"), "block.radius = 0: out of range; give a number above 0 [m]"),
    "slenderness of zero": (
        replaced("0.28", "0.0"),
        "block.slenderness = 0.0: out of range; give a number above 0 [rad]",
    ),
    "slenderness of pi/2": (
        replaced("0.28", "1.5707963267948966"),
        "block.slenderness = 1.5707963267948966: out of range; give a number below 1.5708 [rad]",
    ),
    "inertia of a point": (
        replaced("slenderness", "corner_inertia = 3000\nslenderness"),
        "block.corner_inertia = 3000.0: less than a point mass would have; give more than mass "
        "radius^2 = 3757.66 kg m2, or leave it out",
    ),
    "restitution above 1": (
        replaced("slenderness", "restitution = 1.01\nslenderness"),
        "block.restitution = 1.01: out of range; give a number up to 1",
    ),
    "negative restitution": (
        replaced("slenderness", "restitution = -0.1\nslenderness"),
        "block.restitution = -0.1: out of range; give a number from 0 on",
    ),
    "gravity of zero": (
        replaced("gravity = 9.81", "gravity = 0"),
        "gravity = 0: out of range; give a number above 0 [m/s2]",
    ),
    "negative base mass": (replaced("212.0", "-212.0"), "base.mass = -212.0: out of range; give a number above 0 [kg]"),
    "ka below kb": (
        replaced("6.22e4", "6.22e2"),
        "bearings.ka = 622.0: not above kb = 6220 N/m; give the initial stiffness as ka, the smaller one "
        "after yielding as kb [N/m]",
    ),
    "ka as kb": (
        replaced("6.22e4", "6.22e3"),
        "bearings.ka = 6220.0: not above kb = 6220 N/m; give the initial stiffness as ka, the smaller one "
        "after yielding as kb [N/m]",
    ),
    "alpha of one": (replaced("44.69", "1.0"), "bearings.alpha = 1.0: out of range; give a number above 1"),
    "no bearings at all": (
        replaced("count = 4", "count = 0"),
        "bearings.count = 0: out of range; give a number from 1 on",
    ),
    "large delta_k": (
        replaced("alpha", "delta_k = 1e5\nalpha"),
        "bearings.delta_k = 100000.0: not below ka - kb; give a small stiffness difference [N/m] such as "
        "1e-20, or leave it out",
    ),
    "negative damping": (
        replaced("alpha", "damping = -1\nalpha"),
        "bearings.damping = -1: out of range; give a number from 0 on [N s/m]",
    ),
    "negative frequency": (
        motion('pulse = "one-sine"\namplitude = 1\nfrequency = -2'),
        "motion.frequency = -2: out of range; give a number above 0 [rad/s]",
    ),
    "pulse before zero": (
        motion('pulse = "one-sine"\namplitude = 1\nfrequency = 2\nstart = -1'),
        "motion.start = -1: out of range; give a number from 0 on [s]",
    ),
    "negative seed": (
        motion('synthetic = "duzce-like"\nseed = -1'),
        "motion.seed = -1: out of range; give a number from 0 on",
    ),
    "lying block": (
        replaced("tilt = 0.0", "tilt = 1.6"),
        "start.tilt = 1.6: out of range; give a number below 1.5708 [rad]",
    ),
    "no time": (replaced("20.0", "0.0"), "run.duration = 0.0: out of range; give a number above 0 [s]"),
    # not finite
    "NaN": (replaced("3172.05", "nan"), "block.mass = nan: not finite; give a finite number [kg]"),
    "endless": (replaced("20.0", "inf"), "run.duration = inf: not finite; give a finite number [s]"),
    "NaN amplitude": (
        motion('pulse = "one-sine"\namplitude = nan\nfrequency = 2'),
        "motion.amplitude = nan: not finite; give a finite number [m/s2]",
    ),
    "NaN scale": (
        motion('synthetic = "duzce-like"\nscale = nan'),
        "motion.scale = nan: not finite; give a finite number",
    ),
    # parts that do not fit
    "bearings without base": (
        replaced("[base]\nmass = 212.0\n", ""),
        "bearings: need a base to carry; add a table [base] with its mass",
    ),
    "moving base without base": (
        lambda text: text[: text.index("[base]")] + "[start]\nbase_velocity = 0.5\n" + text[text.index("[run]") :],
        "start.base_velocity = 0.5: needs a base; add a table [base] with its mass, or remove it",
    ),
    "several motions": (
        motion('synthetic = "duzce-like"\npulse = "one-sine"\namplitude = 1\nfrequency = 2'),
        f"motion = 'pulse, synthetic': names several motions at once; {ONE_OF}",
    ),
    "three motions": (
        motion('synthetic = "duzce-like"\npulse = "one-sine"\nrecord = "two.txt"'),
        f"motion = 'record, pulse, synthetic': names several motions at once; {ONE_OF}",
    ),
    "no motion": (motion(""), f"motion: names no motion; {ONE_OF}"),
    "only a scale": (motion("scale = 2.0"), f"motion: names no motion; {ONE_OF}"),
    "amplitude of a synthetic": (
        motion('synthetic = "duzce-like"\namplitude = 2.0'),
        "motion.amplitude = 2.0: belongs to a pulse, not to a synthetic; remove it",
    ),
    "seed of a pulse": (
        motion('pulse = "one-sine"\namplitude = 1\nfrequency = 2\nseed = 3'),
        "motion.seed = 3: belongs to a synthetic, not to a pulse; remove it",
    ),
    "units of a pulse": (
        motion('pulse = "one-sine"\namplitude = 1\nfrequency = 2\nunits = "g"'),
        "motion.units = 'g': belongs to a record, not to a pulse; remove it",
    ),
    "vertical file of a pulse": (
        motion('pulse = "one-sine"\namplitude = 1\nfrequency = 2\nvertical = "two.txt"'),
        "motion.vertical = 'two.txt': belongs to a record, not to a pulse; remove it",
    ),
    "vertical ratio of a record": (
        motion('record = "good.AT2"\nvertical_ratio = 0.5'),
        "motion.vertical_ratio = 0.5: belongs to a pulse or a synthetic, not to a record; remove it",
    ),
    "vertical phase without a ratio": (
        motion('pulse = "one-sine"\namplitude = 1\nfrequency = 2\nvertical_phase = 1'),
        "motion.vertical_phase = 1.0: without a vertical motion; add vertical_ratio = ...",
    ),
    "vertical phase of a pulse without one": (
        motion('pulse = "ricker"\namplitude = 1\nfrequency = 2\nvertical_ratio = 1\nvertical_phase = 1'),
        "motion.vertical_phase = 1.0: a ricker pulse has none; leave it out, or choose a sine or cosine",
    ),
    "vertical file that is not there": (
        motion('record = "good.AT2"\nvertical = "nowhere.AT2"'),
        "motion.vertical = 'nowhere.AT2': cannot be read",
    ),
    "vertical channel of a file that has none": (
        motion('record = "good.AT2"\nvertical_channel = 3'),
        "motion.vertical_channel = '3': but the file has no several channels (good.AT2); remove vertical_channel",
    ),
    "vertical file without a unit": (
        motion('record = "good.AT2"\nvertical = "two.txt"'),
        "motion.units: missing; columns of numbers carry no unit (two.txt); add units, one of m/s2, cm/s2, g",
    ),
    "channel of a file that has none": (
        motion('record = "good.AT2"\nchannel = 1'),
        "motion.channel = '1': but the file has no several channels (good.AT2); remove channel",
    ),
    "column of a file that has none": (
        motion('record = "good.AT2"\ncolumn = 2'),
        "motion.column = 2: but the file is PEER AT2 (good.AT2); remove column",
    ),
    "column of a vertical motion that has none": (
        motion('record = "good.AT2"\nvertical_column = 3'),
        "motion.vertical_column = 3: but the file is PEER AT2 (good.AT2); remove vertical_column",
    ),
    "column that is none": (
        motion('record = "two.txt"\ncolumn = 0'),
        "motion.column = 0: but the file has 2 columns (two.txt); give column, 2",
    ),
    "other step than that of the record": (
        motion('record = "good.AT2"\ndt = 0.5'),
        "motion.dt = 0.5: but the step of the record itself is 0.01 s (good.AT2); remove dt, or correct the record",
    ),
    "channel that is no name": (
        motion('record = "good.AT2"\nchannel = 1.5'),
        'motion.channel = 1.5: wrong type (float); give text in "quotes"',
    ),
    "other units than the AT2 states": (
        motion('record = "good.AT2"\nunits = "m/s2"'),
        "motion.units = 'm/s2': but the record carries its own unit, G (line 3) "
        "(good.AT2); remove units, or correct the record",
    ),
    "too large a scale": (
        motion('record = "good.AT2"\nscale = 1e9'),
        "motion.scale = 1000000000.0: makes a peak of 2e+08 g (good.AT2); give a smaller one",
    ),
    "key with a point": (replaced("name =", '"block.mass" = 1\nname ='), "block.mass = 1: unknown key; write block"),
    "table with a point": (replaced("name =", '"a.b" = 1\nname ='), "a.b = 1: unknown key; remove it, known are name"),
    "seed of thousands of digits": (
        motion('synthetic = "duzce-like"\nseed = ' + "9" * 4000),
        "motion.seed = an integer of 13288 bits: out of range; give a number below",
    ),
    "mass of thousands of digits": (replaced("3172.05", "9" * 5000), "scene: is not valid TOML (Exceeds the limit"),
    "huge mass": (replaced("3172.05", "1e308"), "block.mass = 1e+308: out of range; give a number up to 1e+20 [kg]"),
    "vanishing radius": (
        replaced("1.0884", "1e-308"),
        "block.radius = 1e-308: out of range; give a number from 1e-20 on [m]",
    ),
    "huge count": (
        replaced("count = 4", "count = 10000000"),
        "bearings.count = 10000000: out of range; give a number up to 1e+06",
    ),
    "NUL in a path": (
        motion('record = "a\\u0000b"'),
        "motion.record = 'a\\x00b': cannot be read (a path cannot contain such",
    ),
    "path too long": (
        motion('record = "' + "a" * 300 + '"'),
        f"motion.record = '{'a' * 80}' ... (300 characters): cannot be read",
    ),
    "a device": (
        motion('record = "/dev/zero"'),
        "motion.record = '/dev/zero': cannot be read (is a device, not a file",
    ),
    "a folder": (motion('record = "."'), "motion.record = '.': cannot be read (Is a directory)"),
    "long name of a key": (
        lambda text: "a" * 5000 + " = 1\n" + text,
        f"{'a' * 66} ... {'a' * 16} (5000 characters) = 1: unknown key",
    ),
    "long text": (
        replaced("3172.05", '"' + "a" * 5000 + '"'),
        f"block.mass = '{'a' * 80}' ... (5000 characters): wrong type (str)",
    ),
    "deep list": (lambda text: "a = " + "[" * 20000 + "]" * 20000 + "\n" + text, "scene: is nested too deeply"),
    "deep key": (lambda text: ".".join("a" * 20000) + " = 1\n" + text, "scene: line 1 is nested too deeply"),
    "large file": (lambda text: "#" * 100_000 + "\n" + text, "scene: cannot be read (holds more than 0.1 MB)"),
    # records
    "no record": (
        motion('record = "no.AT2"'),
        "motion.record = 'no.AT2': cannot be read (No such file or directory); give the path of a record, "
        "relative to the scene file",
    ),
    "empty record": (
        motion('record = "empty.AT2"'),
        "motion.record = 'empty.AT2': is empty; give a record with at least two accelerations",
    ),
    "record without samples": (
        motion('record = "none.AT2"'),
        "motion.record = 'none.AT2': holds 0 samples; give at least two accelerations",
    ),
    "cut record": (
        motion('record = "short.AT2"'),
        "motion.record = 'short.AT2': line 4, NPTS = 3: but 2 samples follow; the file is cut or damaged: "
        "fetch it again",
    ),
    "uneven record": (
        motion('record = "uneven.txt"\nunits = "g"'),
        "motion.record = 'uneven.txt': sample 3, time = 0.03: the sampling is not uniform: this step is "
        "0.02 s, most are 0.01 s; resample the record at equal intervals",
    ),
    "NaN in a record": (
        motion('record = "nan.txt"\nunits = "g"'),
        "motion.record = 'nan.txt': line 2 = 'nan': not finite; mend or remove it",
    ),
    "unknown format": (
        motion('record = "odd.dat"'),
        "motion.record = 'odd.dat': line 1 = 'what is this': not a known record format; give PEER AT2 "
        "(a line NPTS= ..., DT= ...), ESM/DYNA 1.2, CSMIP volume 2, COSMOS, K-NET, SMC or columns of numbers",
    ),
    # the file itself
    "no TOML": (replaced("[run]", "[run"), "scene: is not valid TOML ("),  # the rest is Python's own wording
    "key twice": (replaced("mass = 212.0", "mass = 212.0\nmass = 213.0"), "scene: is not valid TOML ("),
    "empty file": (lambda text: "", "block: missing; add a table [block]"),
}
