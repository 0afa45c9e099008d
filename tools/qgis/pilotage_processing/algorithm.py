"""A command of the program as an algorithm: parameters from its described options, layers from its files."""

import json
import pathlib
import shlex

from qgis.core import (QgsProcessing, QgsProcessingAlgorithm, QgsProcessingContext, QgsProcessingException, QgsProcessingLayerPostProcessorInterface,
                       QgsProcessingOutputString, QgsProcessingParameterBoolean, QgsProcessingParameterDefinition, QgsProcessingParameterEnum,
                       QgsProcessingParameterFile, QgsProcessingParameterFileDestination, QgsProcessingParameterFolderDestination,
                       QgsProcessingParameterMultipleLayers, QgsProcessingParameterNumber, QgsProcessingParameterRasterLayer,
                       QgsProcessingParameterString, QgsProviderRegistry, QgsRasterLayer, QgsVectorLayer)

from .described import inputs_of, kind_of, python_name, sections_of, spec_of
from .errors import GateNotMet, Interrupted
from .program import run_command

# Options whose paths are rasters of the project; other paths are files.
RASTERS = {"elevation", "second_epoch"}
LISTS_OF_RASTERS = {"imagery", "second_epoch"}
OUTPUT_FILTERS = {"score": "GeoTIFF (*.tif)", "reroute": "Route (*.plan *.waypoints *.kml *.gpx *.geojson)", "report": "Page (*.html)"}
PLAIN_SECTIONS = 3  # a command's own options, camera and inertial system of most; what follows is advanced


class ShownAsStored(QgsProcessingLayerPostProcessorInterface):
    """The style that the program wrote beside the raster, or into the GeoPackage."""

    kept = []  # QGIS does not own them

    @classmethod
    def create(cls):
        cls.kept.append(cls())
        return cls.kept[-1]

    def postProcessLayer(self, layer, context, feedback):
        layer.loadDefaultStyle()
        layer.triggerRepaint()


def label_of(option):
    words = option["name"].replace(".", ": ").replace("_", " ")
    if "unit" in option:
        suffix = words.rfind(" ")
        words = f"{words[:suffix]} [{option['unit']}]" if suffix > 0 else f"{words} [{option['unit']}]"
    return words[:1].upper() + words[1:]


def parameter_of(option):
    """A parameter for an option; what is not set is as the program has it."""
    name, label, default, kind = python_name(option["flag"]), label_of(option), option["default"], kind_of(option)
    if kind == "boolean":
        return QgsProcessingParameterBoolean(name, label, defaultValue=default)
    if "choices" in option:
        several = option["type"] == "texts"
        return QgsProcessingParameterEnum(name, label, options=option["choices"], allowMultiple=several, defaultValue=default or None,
                                          optional=True, usesStaticStrings=True)
    if kind in ("integer", "number"):
        whole = QgsProcessingParameterNumber.Integer if kind == "integer" else QgsProcessingParameterNumber.Double
        limits = {}
        if "minimum" in option and option["maximum"] < 1e15:
            limits = {"minValue": option["minimum"], "maxValue": option["maximum"]}
        return QgsProcessingParameterNumber(name, label, type=whole, defaultValue=default, optional=True, **limits)
    if kind == "paths" and option["name"] in LISTS_OF_RASTERS:
        return QgsProcessingParameterMultipleLayers(name, label, layerType=QgsProcessing.TypeRaster, optional=True)
    if kind == "path" and option["name"] in RASTERS:
        return QgsProcessingParameterRasterLayer(name, label, optional=True)
    if kind == "path":
        return QgsProcessingParameterFile(name, label, optional=True)
    return QgsProcessingParameterString(name, label, defaultValue=", ".join(map(str, default)) if isinstance(default, list) else default or None,
                                        optional=True)


class CommandAlgorithm(QgsProcessingAlgorithm):
    def __init__(self, command):
        super().__init__()
        self.command = command

    def createInstance(self):
        return CommandAlgorithm(self.command)

    def name(self):
        return self.command["word"].replace("-", "_")

    def displayName(self):
        return self.command["word"].capitalize()

    def shortDescription(self):
        return self.command["summary"]

    def shortHelpString(self):
        lines = [self.command["summary"] + ".", "What is not set is as the program has it."]
        for heading, options in sections_of(self.command):
            if heading:
                lines.append(f"<b>{heading}</b>")
            lines += [f"<i>{label_of(option)}</i>: {option['help']}" for option in options if option["name"] not in ("output", "config")]
        return "<br/>".join(lines)

    def helpUrl(self):
        return ""

    def initAlgorithm(self, configuration=None):
        for name, several, required in inputs_of(self.command):
            if self.command["inputs"]["is_config"]:
                self.addParameter(QgsProcessingParameterFile(name, "Mission file", extension="json", optional=True))
            elif several and name == "raster":
                self.addParameter(QgsProcessingParameterMultipleLayers(name, "Imagery", layerType=QgsProcessing.TypeRaster))
            else:
                self.addParameter(QgsProcessingParameterFile(name, "Tile plan (plan.json)", extension="json", optional=not required))
        for number, (_, options) in enumerate(sections_of(self.command)):
            for option in options:
                if option["name"] in ("output", "config"):
                    continue
                parameter = parameter_of(option)
                parameter.setHelp(option["help"])
                if number >= PLAIN_SECTIONS:
                    parameter.setFlags(parameter.flags() | QgsProcessingParameterDefinition.FlagAdvanced)
                self.addParameter(parameter)
        if self.command["output"]["kind"] == "folder":
            self.addParameter(QgsProcessingParameterFolderDestination("output", "Folder"))
        else:
            self.addParameter(QgsProcessingParameterFileDestination("output", "Output", fileFilter=OUTPUT_FILTERS[self.command["word"]]))
        for name, label in (("headline", "Verdict or headline"), ("result", "All that the program says, as JSON")):
            self.addOutput(QgsProcessingOutputString(name, label))

    def _rasters(self, parameters, name, context):
        return [layer.source() for layer in self.parameterAsLayerList(parameters, name, context)]

    def _value_of(self, option, parameters, context):
        """As the program's options have it, or None where it is what the program takes anyway."""
        name, kind, default = python_name(option["flag"]), kind_of(option), option["default"]
        if parameters.get(name) is None:
            return None
        if kind == "boolean":
            value = self.parameterAsBool(parameters, name, context)
        elif "choices" in option:
            several = option["type"] == "texts"
            value = self.parameterAsEnumStrings(parameters, name, context) if several else self.parameterAsEnumString(parameters, name, context)
        elif kind == "integer":
            value = self.parameterAsInt(parameters, name, context)
        elif kind == "number":
            value = self.parameterAsDouble(parameters, name, context)
        elif kind == "paths" and option["name"] in LISTS_OF_RASTERS:
            value = self._rasters(parameters, name, context)
        elif kind == "path" and option["name"] in RASTERS:
            layer = self.parameterAsRasterLayer(parameters, name, context)
            value = layer.source() if layer is not None else ""
        elif kind == "path":
            value = self.parameterAsFile(parameters, name, context)
        else:
            value = self.parameterAsString(parameters, name, context)
            if kind in ("texts", "numbers", "paths"):
                value = [part.strip() for part in value.split(",") if part.strip()]
                value = [float(part) for part in value] if kind == "numbers" else value
        return None if value == default or value in ("", []) else value

    def _arguments(self, parameters, context):
        given = {}
        for name, several, _ in inputs_of(self.command):
            value = (self._rasters(parameters, name, context) if several and name == "raster"
                     else self.parameterAsFile(parameters, name, context))
            given[name] = value or None
        for _, options in sections_of(self.command):
            for option in options:
                if option["name"] not in ("output", "config"):
                    given[python_name(option["flag"])] = self._value_of(option, parameters, context)
        given["output"] = (self.parameterAsString(parameters, "output", context) if self.command["output"]["kind"] == "folder"
                           else self.parameterAsFileOutput(parameters, "output", context))
        return given

    def processAlgorithm(self, parameters, context, feedback):
        share = 0.0

        def progress(what, done, total):
            nonlocal share
            part, parts, words = 1, 1, what
            head, colon, rest = what.partition(": ")
            if colon and head.replace(" of ", "").isdigit():  # "2 of 6: score"
                (part, parts), words = map(int, head.split(" of ")), rest
            feedback.setProgressText(words)
            # A part may count several things, one after the other: the bar does not go back.
            share = max(share, 100 * (part - 1 + (min(done / total, 1) if total else 0)) / parts)
            feedback.setProgress(share)
            return not feedback.isCanceled()

        given = self._arguments(parameters, context)
        try:
            result = run_command(spec_of(self.command), {**given, "progress": progress})
        except Interrupted:
            return {}
        except GateNotMet as unmet:
            feedback.reportError(str(unmet))
            result = unmet.result
        except Exception as error:
            raise QgsProcessingException(str(error)) from error
        feedback.pushCommandInfo(shlex.join(result.command))
        for warning in result.get("warnings", []):
            feedback.pushWarning(warning)
        headline = result.get("verdict") or result.get("headline") or ""
        for said in (headline, result.get("detail"), result.get("assumptions"), result.get("evidence"), result.get("not_looked_at")):
            if said:
                feedback.pushInfo("; ".join(said) if isinstance(said, list) else said)
        self._load_layers(given["output"], result, context)
        return {"output": given["output"], "headline": headline, "result": json.dumps(result, ensure_ascii=False)}

    def _load_layers(self, output, result, context):
        """Layers that the program wrote with a style come up in the project when the algorithm has ended."""
        output = pathlib.Path(output)
        folder = output if self.command["output"]["kind"] == "folder" else output.parent
        names = result.get("files") or [output.name]
        for name in names:
            file = folder / name
            if file.suffix == ".tif" and file.with_suffix(".qml").exists():
                self._load(QgsRasterLayer(str(file), file.stem), context)
            elif file.suffix == ".gpkg" and file.name != "map.gpkg":
                for found in QgsProviderRegistry.instance().querySublayers(str(file)):
                    self._load(QgsVectorLayer(found.uri(), f"{file.stem}: {found.name()}", "ogr"), context)

    def _load(self, layer, context):
        if not layer.isValid():
            return
        context.temporaryLayerStore().addMapLayer(layer)
        details = QgsProcessingContext.LayerDetails(layer.name(), context.project(), layer.name())
        details.setPostProcessor(ShownAsStored.create())
        context.addLayerToLoadOnCompletion(layer.id(), details)
