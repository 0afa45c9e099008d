"""Runs the program `pilotage`: what stands behind the functions of `pilotage.commands` (docs/decisions/python.md)."""

import collections.abc
import contextlib
import json
import operator
import os
import re
import shutil
import signal
import subprocess
import tempfile
import warnings

from .errors import DataError, GateNotMet, IntegrityError, InternalError, Interrupted, PilotageWarning, TryAgain, UsageError

_KINDS = {"usage": UsageError, "data": DataError, "integrity": IntegrityError, "memory": MemoryError, "interrupted": Interrupted}
_DONE, _GATE_NOT_MET, _INTEGRITY, _TRY_AGAIN = 0, 3, 4, 75  # exit codes
_ENDS_WITHIN_S = 10  # the program ends within a second of being asked to

_checked = {}


class Result(dict):
    """What a command says of its work: the object that `pilotage COMMAND --json` prints (schemas/results).

    `command` is the command line that does the same, as a list of words.
    """

    def __init__(self, values, command):
        super().__init__(values)
        self.command = command


def find_program(version=None):
    """The program: PILOTAGE_PROGRAM, or `pilotage` on the PATH. Throws DataError where it is missing, or of another version than `version`."""
    named = os.environ.get("PILOTAGE_PROGRAM")
    program = shutil.which(named or "pilotage")
    if program is None:
        raise DataError(f"{named}: is no program (PILOTAGE_PROGRAM)" if named else
                        "the program pilotage is not on the PATH; install it, or name it in PILOTAGE_PROGRAM")
    if version is None:
        return program
    if program not in _checked:
        told = subprocess.run([program, "--version"], stdin=subprocess.DEVNULL, capture_output=True, text=True, check=False)
        _checked[program] = told.stdout.split("\n", 1)[0]
    if _checked[program] != f"pilotage {version}":
        raise DataError(f"{program}: is \"{_checked[program]}\", but this module is of pilotage {version}; install both of one version")
    return program


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
    if isinstance(value, (bool, str, bytes)) or not hasattr(value, "__float__"):
        raise TypeError(f"{name} must be a number, not {type(value).__name__}")
    return repr(float(value))


def _integer(name, value):
    try:
        if not isinstance(value, bool):
            return str(operator.index(value))
    except TypeError:
        pass
    raise TypeError(f"{name} must be an integer, not {type(value).__name__}")


def _items(name, value, convert):
    """Each of a list, or the one that is given alone."""
    if isinstance(value, (str, bytes, os.PathLike)) or not isinstance(value, collections.abc.Iterable):
        value = [value]
    return [convert(name, item) for item in value]


def _flags(name, flag, kind, value):
    """One option as it is typed."""
    if kind == "boolean":
        if not isinstance(value, bool) and type(value).__name__ != "bool_":  # numpy's
            raise TypeError(f"{name} must be True or False, not {type(value).__name__}")
        return [f"--{flag}={'true' if value else 'false'}"]
    if kind in ("texts", "numbers"):
        joined = ",".join(_items(name, value, _text if kind == "texts" else _number))
        return [f"--{flag}={joined}"] if joined else [f"--{flag}", ""]
    if kind == "paths":
        return [f"--{flag}={path}" for path in _items(name, value, _path)]
    text = {"path": _path, "text": _text, "number": _number, "integer": _integer}[kind](name, value)
    return [f"--{flag}={text}"] if text else [f"--{flag}", ""]


def _command_line(spec, given):
    """The words after the program's name, and what stands on its standard input: the name of the argument, and its text."""
    words = [spec["word"], "--json", "--progress=" + ("none" if given.get("progress") is None else "json")]
    standard_input = ("", "")
    inputs = []
    for name, many in spec["inputs"]:
        value = given.get(name)
        if value is None:
            continue
        if spec["is_config"] and isinstance(value, collections.abc.Mapping):
            standard_input = (name, json.dumps(value, default=os.fspath))
            inputs.append("-")
        else:
            inputs += _items(name, value, _path) if many else [_path(name, value)]
    for name, (flag, kind) in spec["options"].items():
        value = given.get(name)
        if value is None:
            continue
        if name == "config" and isinstance(value, collections.abc.Mapping):
            standard_input = (name, json.dumps(value, default=os.fspath))
            words.append("--config=-")
        else:
            words += _flags(name, flag, kind, value)
    return words + (["--", *inputs] if inputs else []), standard_input


def _in_words_of_python(message, spec, on_standard_input):
    """Flags are named as they are given here: --agl-m is agl_m; standard input is the dict that stood on it."""
    names = {f"--{flag}": f"{name}=True" if kind == "boolean" else name for name, (flag, kind) in spec["options"].items()}
    if on_standard_input:
        message = message.replace("standard input", on_standard_input)
    return re.sub("--[a-z0-9-]*[a-z0-9]", lambda found: names.get(found[0], found[0]), message)


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
    """Reads what the program says until it ends; each line of progress goes to the callback. Returns what is none."""
    said = []
    for line in process.stderr:
        report = None
        if progress is not None and line.startswith("{"):
            with contextlib.suppress(json.JSONDecodeError):
                report = json.loads(line)
        if report is None:
            said.append(line)
        elif progress(report["what"], report["done"], report["total"]) is False:
            raise Interrupted("interrupted")
    return "".join(said)


def run_command(spec, given, version=None):
    """Runs a command as `spec` (described.py) has it, with the arguments of its function by name; None is not given. Ctrl-C ends it."""
    words, standard_input = _command_line(spec, given)
    command = [find_program(version), *words]
    with tempfile.TemporaryFile("w+", encoding="utf-8") as answer, tempfile.TemporaryFile("w+", encoding="utf-8") as config:
        config.write(standard_input[1])
        config.seek(0)
        # In a session of its own, so that Ctrl-C in a terminal reaches it once, from here.
        with subprocess.Popen(command, stdin=config, stdout=answer, stderr=subprocess.PIPE, text=True, encoding="utf-8", errors="replace",
                              start_new_session=True) as process:
            try:
                said = _follow(process, given.get("progress"))
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
        raise _KINDS.get(values["error"]["kind"], InternalError)(_in_words_of_python(values["error"]["message"], spec, standard_input[0]))
    for warning in values.get("warnings", []):
        warnings.warn(_in_words_of_python(warning, spec, standard_input[0]), PilotageWarning, stacklevel=3)
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
