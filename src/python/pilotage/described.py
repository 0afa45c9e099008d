"""Commands as `pilotage manual --format json` describes them (schemas/commands.schema.json), in words of Python.

Used when the functions of `pilotage.commands` are written, and by the plugin for QGIS, which offers what the installed program has."""

import keyword
import re

# What only a terminal needs; a function has a callback for progress.
_OF_THE_TERMINAL = {"print_config", "print_schema", "json", "quiet", "progress"}


def python_name(text):
    name = re.sub("[^a-z0-9]+", "_", text.lower()).strip("_")
    return name + "_" if keyword.iskeyword(name) else name


def kind_of(option):
    """boolean, integer, number, numbers, text, texts, path or paths."""
    return {"text": "path", "texts": "paths"}.get(option["type"], option["type"]) if option["path"] else option["type"]


def inputs_of(command):
    """Name, whether it takes several, and whether it must be given, of each positional argument."""
    inputs = command["inputs"]
    words = inputs["name"].split() if inputs["max"] != 0 else []
    last = len(words) - 1
    several = inputs["max"] is None or inputs["max"] > len(words)
    return [(python_name(word), several and i == last, i < inputs["min"]) for i, word in enumerate(words)]


def sections_of(command):
    """Heading and options of each section, without those that only a terminal needs."""
    return [(section["heading"], [option for option in section["options"] if option["name"] not in _OF_THE_TERMINAL])
            for section in command["sections"]]


def spec_of(command):
    """What program.run_command() needs of it."""
    return {"word": command["word"], "is_config": command["inputs"]["is_config"],
            "inputs": [(name, several) for name, several, _ in inputs_of(command)],
            "options": {python_name(option["flag"]): (option["flag"][2:], kind_of(option))
                        for _, options in sections_of(command) for option in options}}


def in_words_of_python(text, spec):
    """Flags are named as they are given here: --agl-m is agl_m; what ends the program with 3 is thrown."""
    names = {f"--{flag}": f"{name}=True" if kind == "boolean" else name for name, (flag, kind) in spec["options"].items()}
    names.update({f"--no-{flag}": f"{name}=False" for name, (flag, kind) in spec["options"].items() if kind == "boolean"})
    text = re.sub("--[a-z0-9-]*[a-z0-9]", lambda found: names.get(found[0], found[0]), text)
    return text.replace("Exit with 3", "Throw GateNotMet")
