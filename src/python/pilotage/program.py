"""Runs the program `pilotage`: what stands behind the functions of `pilotage.commands` (docs/decisions/python.md)."""

import collections.abc
import json
import operator
import os
import shutil
import signal
import subprocess
import tempfile
import warnings

from .described import in_words_of_python
from .errors import DataError, GateNotMet, IntegrityError, InternalError, Interrupted, PilotageWarning, TryAgain, UsageError

_KINDS = {"usage": UsageError, "data": DataError, "integrity": IntegrityError, "memory": MemoryError, "interrupted": Interrupted}
_DONE, _GATE_NOT_MET, _INTEGRITY, _TRY_AGAIN = 0, 3, 4, 75  # exit codes
_ENDS_WITHIN_S = 10  # the program ends within a second of being asked to

_checked = set()  # programs that are of the module's version, as they are now


class Result(dict):
    """What a command says of its work: the object that `pilotage COMMAND --json` prints (schemas/results).

    `command` is the command line that does the same, as a list of words.
    """

    def __init__(self, values, command):
        super().__init__(values)
        self.command = command

    def __reduce__(self):
        return Result, (dict(self), self.command)


def find_program(version=None):
    """The program: PILOTAGE_PROGRAM, or `pilotage` on the PATH. Throws DataError where it is missing, or of another version than `version`."""
    named = os.environ.get("PILOTAGE_PROGRAM")
    program = shutil.which(named or "pilotage")
    if program is None:
        raise DataError(f"{named}: is no program (PILOTAGE_PROGRAM)" if named else
                        "the program pilotage is not on the PATH; install it, or name it in PILOTAGE_PROGRAM")
    if version is None:
        return program
    file = os.stat(program)
    state = (program, file.st_ino, file.st_mtime_ns, version)
    if state not in _checked:
        told = subprocess.run([program, "--version"], stdin=subprocess.DEVNULL, capture_output=True, text=True, check=False)
        said = told.stdout.split("\n", 1)[0]
        if said != f"pilotage {version}":
            raise DataError(f"{program}: is \"{said}\", but this module is of pilotage {version}; install both of one version")
        _checked.add(state)
    return program


def _is_bool(value):
    return isinstance(value, bool) or (type(value).__module__ == "numpy" and type(value).__name__ in ("bool_", "bool"))


def _path(name, value):
    text = os.fsdecode(value) if isinstance(value, (str, bytes, os.PathLike)) else None
    if text is None:
        raise TypeError(f"{name} must be a path, not {type(value).__name__}")
    if text == "-":
        raise UsageError(f"{name} = \"-\": standard input and output are for the command line; give a path")
    return text


def _text(name, value):
    if not isinstance(value, str):
        raise TypeError(f"{name} must be a string, not {type(value).__name__}")
    return value


def _number(name, value):
    if _is_bool(value) or isinstance(value, (str, bytes)) or not hasattr(value, "__float__"):
        raise TypeError(f"{name} must be a number, not {type(value).__name__}")
    return repr(float(value))


def _integer(name, value):
    try:
        if not _is_bool(value):
            return str(operator.index(value))
    except TypeError:
        pass
    raise TypeError(f"{name} must be an integer, not {type(value).__name__}")


def _items(name, value, convert):
    """Each of a list, or the one that is given alone."""
    if isinstance(value, (str, bytes, os.PathLike)) or not isinstance(value, collections.abc.Iterable) or getattr(value, "ndim", 1) == 0:
        value = [value]
    items = [convert(name, item) for item in value]
    if not items or not all(items):
        raise UsageError(f"{name} {'holds an empty text' if items else 'is empty'}; leave it out where there is nothing to say")
    return items


def _json_text(name, mapping):
    """A dict as a configuration file; what stands in it may be paths, and numpy's numbers and arrays."""
    def plain(value):
        if hasattr(value, "tolist"):
            return value.tolist()
        if isinstance(value, (bytes, os.PathLike)):
            return os.fsdecode(value)
        raise TypeError(f"{name} holds a {type(value).__name__}: {value!r}")

    try:
        text = json.dumps(mapping, default=plain, allow_nan=False, ensure_ascii=False)
        text.encode()  # names of files that are no UTF-8
        return text
    except ValueError as error:
        raise UsageError(f"{name} holds what JSON cannot: {error}") from None


def _flags(name, flag, kind, value):
    """One option as it is typed."""
    if kind == "boolean":
        if not _is_bool(value):
            raise TypeError(f"{name} must be True or False, not {type(value).__name__}")
        return [f"--{flag}={'true' if value else 'false'}"]
    if kind in ("texts", "numbers"):
        return [f"--{flag}=" + ",".join(_items(name, value, _text if kind == "texts" else _number))]
    if kind == "paths":
        return [f"--{flag}={path}" for path in _items(name, value, _path)]
    text = {"path": _path, "text": _text, "number": _number, "integer": _integer}[kind](name, value)
    return [f"--{flag}={text}"] if text else [f"--{flag}", ""]


def _command_line(spec, given):
    """The words after the program's name, and what stands on its standard input: the name of the argument, and its text."""
    # Progress is asked for although nobody listens: a program that writes it ends when this process is no more.
    words = [spec["word"], "--json", "--progress=json"]
    standard_input = ("", "")
    inputs = []
    for name, several in spec["inputs"]:
        value = given.get(name)
        if value is None:
            continue
        if spec["is_config"] and isinstance(value, collections.abc.Mapping):
            standard_input = (name, _json_text(name, value))
            inputs.append("-")
        else:
            inputs += _items(name, value, _path) if several else [_path(name, value)]
    for name, (flag, kind) in spec["options"].items():
        value = given.get(name)
        if value is None:
            continue
        if name == "config" and isinstance(value, collections.abc.Mapping):
            standard_input = (name, _json_text(name, value))
            words.append("--config=-")
        else:
            words += _flags(name, flag, kind, value)
    return words + (["--", *inputs] if inputs else []), standard_input


def _told(message, spec, on_standard_input):
    """A message of the program: standard input is the dict that stood on it."""
    if on_standard_input:
        message = message.replace("standard input", on_standard_input)
    return in_words_of_python(message, spec)


def _end(process):
    """Asks the program to end, which removes what is unfinished."""
    if process.poll() is None:
        process.send_signal(signal.SIGINT)
        try:
            process.wait(_ENDS_WITHIN_S)
        except subprocess.TimeoutExpired:
            process.kill()
            process.wait()


def _follow(process, progress):
    """Reads what the program says until it ends; of the reports that wait the latest goes to the callback. Returns what is none."""
    said, rest = [], b""
    while chunk := os.read(process.stderr.fileno(), 1 << 16):
        *lines, rest = (rest + chunk).split(b"\n")
        report = None
        for line in lines:
            try:
                report = json.loads(line) if line.startswith(b"{") else None
            except ValueError:
                report = None
            if report is None:
                said.append(line)
        if report is None or progress is None:
            continue
        answer = progress(report["what"], report["done"], report["total"])
        if _is_bool(answer) and not answer:
            raise Interrupted("interrupted")
    return b"\n".join([*said, rest]).decode(errors="replace")


def run_command(spec, given, version=None):
    """Runs a command as `spec` (described.py) has it, with the arguments of its function by name; None is not given. Ctrl-C ends it."""
    progress = given.get("progress")
    if progress is not None and not callable(progress):
        raise TypeError(f"progress must be a function of what, done and total, not {type(progress).__name__}")
    words, standard_input = _command_line(spec, given)
    command = [find_program(version), *words]
    with tempfile.TemporaryFile("w+", encoding="utf-8") as answer, tempfile.TemporaryFile("w+", encoding="utf-8") as config:
        config.write(standard_input[1])
        config.seek(0)
        # In a session of its own, so that Ctrl-C in a terminal reaches it once, from here.
        with subprocess.Popen(command, stdin=config, stdout=answer, stderr=subprocess.PIPE, start_new_session=True) as process:
            try:
                said = _follow(process, progress)
                code = process.wait()
            except BaseException:
                _end(process)
                raise
        answer.seek(0)
        text = answer.read()
    try:
        values = json.loads(text)
    except json.JSONDecodeError:
        ended = f"was ended by signal {-code}" if code < 0 else f"ended with {code} and no answer"
        raise InternalError(f"pilotage {spec['word']} {ended}{': ' + said.strip() if said.strip() else ''}") from None
    if "error" in values:
        raise _KINDS.get(values["error"]["kind"], InternalError)(_told(values["error"]["message"], spec, standard_input[0]))
    for warning in values.get("warnings", []):
        warnings.warn(_told(warning, spec, standard_input[0]), PilotageWarning, stacklevel=3)
    result = Result(values, command)
    if code == _DONE:
        return result
    if code == _GATE_NOT_MET:
        raise GateNotMet(values.get("verdict") or f"pilotage {spec['word']}: a gate that was asked for is not met", result)
    if code == _TRY_AGAIN:
        raise TryAgain(f"pilotage {spec['word']}: not all is there yet", result)
    problems = [problem["message"] for problem in values.get("problems", [])]
    error = (IntegrityError if code == _INTEGRITY else DataError)("; ".join(problems) or f"pilotage {spec['word']} ended with {code}")
    error.result = result
    raise error
