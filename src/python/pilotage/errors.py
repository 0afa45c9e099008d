"""What goes wrong, by kind: as the library throws it, and as the program's exit codes tell it (docs/conventions.md)."""


class UsageError(ValueError):
    """What was asked for is not allowed: a value outside its range, options that exclude each other."""


class DataError(RuntimeError):
    """The input or the machine does not allow what was asked: an unreadable raster, a damaged map, a full disk."""


class IntegrityError(DataError):
    """A digest or a signature is wrong, or a map is not the one that was asked for."""


class InternalError(RuntimeError):
    """An error of Pilotage's own."""


class Interrupted(Exception):
    """A progress callback returned False, or the program was told to end. No output is left behind."""


class GateNotMet(Exception):
    """The work is done and its outputs are written, but a gate that was asked for (`require=True`) is not met.

    `result` is what the function would have returned.
    """

    def __init__(self, message, result):
        super().__init__(message)
        self.result = result

    def __reduce__(self):  # so that it comes back from another process
        return type(self), (self.args[0], self.result)


class TryAgain(Exception):
    """What is waited for is not there yet, as results of other machines: call again later. `result` says what is there."""

    def __init__(self, message, result):
        super().__init__(message)
        self.result = result

    def __reduce__(self):
        return type(self), (self.args[0], self.result)


class PilotageWarning(UserWarning):
    """What a planner should look at and what is no error. Also in the result, under "warnings"."""
