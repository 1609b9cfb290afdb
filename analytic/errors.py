"""Errors a user can mend: each names where, what and the remedy."""


class SceneError(ValueError):
    """A scene that cannot be simulated.

    Parameters
    ----------
    key : str
        Dotted name of the field, as in a scene file (``block.mass``).
    value : object
        What was found there.
    problem, remedy : str
        What is wrong with it, and what to write instead.
    file : str or None
        The scene file or record, where there is one.
    """

    def __init__(self, key, value, problem, remedy, file=None):
        self.key, self.value, self.problem, self.remedy, self.file = key, value, problem, remedy, file
        super().__init__(key, value, problem, remedy, file)

    def __str__(self):
        where = f"{self.file}: " if self.file else ""
        found = "" if self.value is None else f" = {self.value!r}"
        return f"{where}{self.key}{found}: {self.problem}; {self.remedy}"

    def in_file(self, file):
        """The same error, naming the file it was found in."""
        return SceneError(self.key, self.value, self.problem, self.remedy, str(file))


class EngineNotInstalled(ImportError):
    """An engine was asked for that is not installed; the message says how to install it."""


class SettingError(ValueError):
    """A solver setting that does not exist or is out of range."""
