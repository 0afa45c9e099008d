"""The group of algorithms: what the installed program says that its commands take."""

import json
import os
import pathlib
import subprocess

from processing.core.ProcessingConfig import ProcessingConfig, Setting
from qgis.core import QgsMessageLog, QgsProcessingProvider, Qgis
from qgis.PyQt.QtGui import QIcon

from .algorithm import CommandAlgorithm
from .described import spec_of
from .errors import DataError
from .program import find_program

PROGRAM = "PILOTAGE_PROGRAM"
COMMANDS = ("prepare", "survey", "reroute", "score", "report")


class Provider(QgsProcessingProvider):
    def __init__(self):
        super().__init__()
        self._of_the_environment = os.environ.get(PROGRAM, "")

    def id(self):
        return "pilotage"

    def name(self):
        return "Pilotage"

    def icon(self):
        return QIcon(str(pathlib.Path(__file__).with_name("icon.svg")))

    def load(self):
        ProcessingConfig.settingIcons[self.name()] = self.icon()
        ProcessingConfig.addSetting(Setting(self.name(), PROGRAM, "Program pilotage (empty: the one on the PATH)", "", valuetype=Setting.FILE))
        ProcessingConfig.readSettings()
        self.refreshAlgorithms()
        return True

    def unload(self):
        ProcessingConfig.removeSetting(PROGRAM)
        os.environ[PROGRAM] = self._of_the_environment

    def loadAlgorithms(self):
        os.environ[PROGRAM] = ProcessingConfig.getSetting(PROGRAM) or self._of_the_environment
        try:
            # Into a pipe of its own: QGIS on Windows has no standard output.
            told = subprocess.run([find_program(), "manual", "--format", "json"], stdin=subprocess.DEVNULL, capture_output=True, check=True)
            commands = {command["word"]: command for command in json.loads(told.stdout)["commands"]}
        except (DataError, OSError, subprocess.CalledProcessError, ValueError) as error:
            QgsMessageLog.logMessage(f"no algorithms: {error}", self.name(), Qgis.Warning)
            return
        for word in COMMANDS:
            self.addAlgorithm(CommandAlgorithm(commands[word], spec_of(commands[word])))
