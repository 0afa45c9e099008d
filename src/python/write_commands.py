"""Writes the Python functions of the program's commands: write_commands.py DESCRIPTION COMMANDS_PY STUB_TEMPLATE STUB

DESCRIPTION is what `pilotage manual --format json` prints (schemas/commands.schema.json). COMMANDS_PY becomes pilotage/commands.py, one
function for each command, whose keyword arguments, types and docstring are those of the described options. STUB_TEMPLATE becomes STUB:
the arguments of matching, which the extension module takes by the same description, stand where it has @MATCH_OPTIONS@."""

import json
import pathlib
import sys
import textwrap

sys.path.insert(0, str(pathlib.Path(__file__).parent / "pilotage"))  # not the package, which is being made
from described import in_words_of_python, inputs_of, kind_of, python_name, sections_of, spec_of

WIDTH = 138
TYPES = {"boolean": "bool", "integer": "int", "number": "float", "numbers": "float | Sequence[float]"}


def type_of(option):
    kind = kind_of(option)
    if "choices" in option:
        names = "Literal[" + ", ".join(f'"{choice}"' for choice in option["choices"]) + "]"
        return names + (f" | Sequence[{names}]" if kind == "texts" else "")
    return {"path": "Path", "paths": "Path | Sequence[Path]", "text": "str", "texts": "str | Sequence[str]"}.get(kind) or TYPES[kind]


def shown(value):
    if isinstance(value, list):
        return ", ".join(shown(item) for item in value)
    return f"{value:.15g}" if isinstance(value, float) else str(value)


def limits_of(option):
    limits = [option["unit"]] if "unit" in option else []
    if "minimum" in option:
        low, high = option["minimum"], option["maximum"]
        limits.append(f"at least {low:.15g}" if high >= 1e15 else f"{low:.15g} to {high:.15g}")
    if option["default"] not in (None, "", []):
        limits.append(f"default {shown(option['default'])}")
    return f" [{'; '.join(limits)}]" if limits else ""


def wrapped(text, indent, hanging=4):
    return textwrap.wrap(text, WIDTH, initial_indent=" " * indent, subsequent_indent=" " * (indent + hanging), break_long_words=False,
                         break_on_hyphens=False)


def python_argument(option):
    return python_name(option["flag"])


def docstring_of(command):
    spec = spec_of(command)
    lines = wrapped(f'r"""{command["summary"]}.', 4, 0) + [""]
    lines += wrapped(f"`{command['usage']}`: what is not given is as the program has it. Returns what `--json` prints, as schemas/results/"
                     f"{command['word']}.json says; docs/commands/{command['word']}.md has the rest.", 4, 0)
    lines += ["", "    Args:"]
    for i, (name, _, _) in enumerate(inputs_of(command)):
        more = " Or the options of a mission file as a dict." if command["inputs"]["is_config"] else ""
        lines += wrapped(f"{name}: {in_words_of_python(command['inputs']['help'], spec)}{more}" if i == 0 else f"{name}: As above.", 8)
    for heading, options in sections_of(command):
        if heading and options:
            lines += ["", *wrapped(in_words_of_python(heading, spec), 8)]
        for option in options:
            if option["name"] == "output" and command["output"]["kind"] != "none":
                option = {**option, "help": command["output"]["help"], "default": ""}
            elif option["name"] == "config":
                option = {**option, "help": "Options from a JSON file, or as a dict; arguments win over it."}
            lines += wrapped(f"{python_argument(option)}: {in_words_of_python(option['help'], spec)}{limits_of(option)}", 8)
    lines += wrapped("progress: Called with what is done, how much of it, and how much there is in all (0: not known), by the calling "
                     "thread, some times a second. What returns False ends the work (Interrupted).", 8)
    lines += ["", "    Raises:"]
    for what in ("UsageError: an argument is missing, outside its range, or excludes another.",
                 "DataError: a file cannot be read or written, or is damaged; IntegrityError: a digest or a signature is wrong.",
                 "GateNotMet: the work is done, but what `require…` asks for is not met.",
                 "Interrupted, KeyboardInterrupt: it was ended; no output is left behind."):
        lines += wrapped(what, 8)
    return "\n".join(lines) + '\n    """\n'


def function_of(command):
    arguments = []
    for name, several, required in inputs_of(command):
        kind = "Path | Mapping[str, Any]" if command["inputs"]["is_config"] else "Path | Sequence[Path]" if several else "Path"
        arguments.append(f"{name}: {kind}" + ("" if required else " | None = None"))
    arguments.append("*")
    later = []
    for _, options in sections_of(command):
        for option in options:
            name = python_argument(option)
            if name == "output" and command["output"]["required"]:
                arguments.append("output: Path")
            elif name == "config":
                later.append("config: Path | Mapping[str, Any] | None = None")
            else:
                later.append(f"{name}: {type_of(option)} | None = None")
    arguments += later + ["progress: Progress | None = None"]
    name = python_name(command["word"])
    text = "\n\ndef " + name + "(\n" + "".join(f"    {argument},\n" for argument in arguments) + ") -> Result:\n"
    return text + docstring_of(command) + f"    return run_command(_COMMANDS[{name!r}], locals(), VERSION)\n", (name, spec_of(command))


def commands_module(description):
    functions, specs = zip(*(function_of(command) for command in description["commands"]))
    text = ('"""Each command of the program `pilotage` as a function. Written from the described options by src/python/write_commands.py."""\n\n'
            "from __future__ import annotations\n\nimport os\nfrom collections.abc import Callable, Mapping, Sequence\n"
            "from typing import Any, Literal, Optional, Union\n\nfrom .program import Result, run_command\n\n"
            f"VERSION = {description['version']!r}\n"
            'Path = Union[str, bytes, "os.PathLike[str]"]\n'
            "Progress = Callable[[str, int, int], Optional[bool]]\n\n__all__ = [\n")
    text += "".join(f"    {name!r},\n" for name, _ in specs) + "]\n\n_COMMANDS = {\n"
    for name, spec in specs:
        text += f"    {name!r}: {{\n"
        for key, value in spec.items():
            if key == "options":
                text += "        'options': {\n" + "".join(f"            {option!r}: {entry!r},\n" for option, entry in value.items()) + "        },\n"
            else:
                text += f"        {key!r}: {value!r},\n"
        text += "    },\n"
    return text + "}\n" + "".join(functions)


def match_options(description):
    """The arguments of matching, and what they mean."""
    command = next(command for command in description["commands"] if command["word"] == "match")
    options = [option for _, section in sections_of(command) for option in section if option["name"].startswith("match.")]
    return [(option["name"].removeprefix("match."), option) for option in options]


def stub(template, description):
    arguments = "".join(f"        {name}: {type_of(option)} = ...,\n" for name, option in match_options(description))
    return template.replace("        @MATCH_OPTIONS@\n", arguments)


def main():
    with open(sys.argv[1], encoding="utf-8") as file:
        description = json.load(file)
    with open(sys.argv[3], encoding="utf-8") as file:
        template = file.read()
    for path, text in ((sys.argv[2], commands_module(description)), (sys.argv[4], stub(template, description))):
        with open(path, "w", encoding="utf-8") as file:
            file.write(text)


main()
