"""A command of the program as an algorithm: parameters from its described options, layers from its files."""

import json
import pathlib
import shlex

from qgis.core import (QgsMapLayer, QgsProcessing, QgsProcessingAlgorithm, QgsProcessingContext, QgsProcessingException, QgsProcessingLayerPostProcessorInterface,
                       QgsProcessingOutputString, QgsProcessingParameterBoolean, QgsProcessingParameterDefinition, QgsProcessingParameterEnum,
                       QgsProcessingParameterFile, QgsProcessingParameterFileDestination, QgsProcessingParameterFolderDestination,
                       QgsProcessingParameterMultipleLayers, QgsProcessingParameterNumber, QgsProcessingParameterRasterLayer,
                       QgsProcessingParameterString, QgsProcessingUtils, QgsProviderRegistry, QgsRasterLayer, QgsVectorLayer)
from qgis.PyQt.QtCore import QVariant

from .described import in_words_of_python, inputs_of, kind_of, python_name, sections_of
from .errors import GateNotMet, Interrupted
from .program import run_command

# Options, by the last word of their name, whose paths are rasters of the project; other paths are files.
RASTERS = {"elevation", "second_epoch", "imagery"}
# Options that name further outputs, and those that are for other places than this: many machines, two reports.
MORE_OUTPUTS = {"score": {"table", "second_epoch_output"}, "report": {"report_json", "pdf"}}
LEFT_OUT = {"output", "config", "plan_shards", "shard", "shards", "level", "compare"}
OUTPUT_FILTERS = {"score": "GeoTIFF (*.tif)", "reroute": "Route (*.plan *.waypoints *.kml *.gpx *.geojson)", "report": "Page (*.html)"}
OUTPUT_SUFFIXES = {"score": ".tif", "reroute": ".plan", "report": ".html"}
OF_THE_RUN = {"overwrite", "threads", "seed", "allow_network", "allow_any_vrt"}  # no mission file says them
YES_OR_NO = ["no", "yes"]
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


def listed(default):
    return ", ".join(map(str, default)) if isinstance(default, list) else default


def help_of(option, spec):
    several = " Several are joined by semicolons." if kind_of(option) == "paths" else ""
    shown = listed(option["default"])
    return in_words_of_python(option["help"], spec) + several + ("" if shown in (None, "", False) else f" Default: {shown}.")


def parameter_of(option, with_file):
    """A parameter for an option. Where a mission file may say the same (`with_file`), nothing is set until the user sets it, for a default that
    is shown would be taken for what is done; elsewhere the program's default is shown."""
    name, label, kind = python_name(option["flag"]), label_of(option), kind_of(option)
    default = None if with_file else option["default"]
    if kind == "boolean" and with_file:
        return QgsProcessingParameterEnum(name, label, options=YES_OR_NO, defaultValue=None, optional=True, usesStaticStrings=True)
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
    if kind == "paths" and is_raster(option):
        return QgsProcessingParameterMultipleLayers(name, label, layerType=QgsProcessing.TypeRaster, optional=True)
    if kind == "path" and is_raster(option):
        return QgsProcessingParameterRasterLayer(name, label, optional=True)
    if kind == "path":
        return QgsProcessingParameterFile(name, label, optional=True)
    return QgsProcessingParameterString(name, label, defaultValue=listed(default) or None, optional=True)


def is_raster(option):
    return option["name"].rsplit(".", 1)[-1] in RASTERS


def source_of(value, context):
    """Of a layer, or of what names one: a layer of the project, else what GDAL opens, which is not opened here, for QGIS would write beside it."""
    layer = value if isinstance(value, QgsMapLayer) else QgsProcessingUtils.mapLayerFromString(value, context, False)
    if layer is None:
        return value
    if layer.dataProvider() is None or layer.dataProvider().name() != "gdal":
        raise QgsProcessingException(f"{layer.name()}: is no raster that GDAL opens by its name; save it as GeoTIFF first")
    return layer.source().split("|option:")[0]


class CommandAlgorithm(QgsProcessingAlgorithm):
    def __init__(self, command, spec):
        super().__init__()
        self.command, self.spec = command, spec

    def createInstance(self):
        return CommandAlgorithm(self.command, self.spec)

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
            lines += [f"<i>{label_of(option)}</i>: {help_of(option, self.spec)}" for option in options if option["name"] not in LEFT_OUT]
        return "<br/>".join(lines)

    def initAlgorithm(self, configuration=None):
        for name, several, required in inputs_of(self.command):
            if self.command["inputs"]["is_config"]:
                self.addParameter(QgsProcessingParameterFile(name, "Mission file", extension="json", optional=True))
            elif several and name == "raster":
                self.addParameter(QgsProcessingParameterMultipleLayers(name, "Imagery", layerType=QgsProcessing.TypeRaster))
            else:
                self.addParameter(QgsProcessingParameterFile(name, "Folder that prepare wrote", behavior=QgsProcessingParameterFile.Folder,
                                                             optional=not required))
        for number, (_, options) in enumerate(sections_of(self.command)):
            for option in options:
                if option["name"] in LEFT_OUT:
                    continue
                if option["name"] in MORE_OUTPUTS.get(self.command["word"], ()):
                    self.addParameter(QgsProcessingParameterFileDestination(python_name(option["flag"]), label_of(option), optional=True,
                                                                            createByDefault=False))
                    continue
                parameter = parameter_of(option, self.command["inputs"]["is_config"] and option["name"] not in OF_THE_RUN)
                parameter.setHelp(help_of(option, self.spec))
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
        value = parameters.get(name) or []
        return [source_of(item, context) for item in (value if isinstance(value, (list, tuple)) else [value])]

    def _value_of(self, option, parameters, context):
        """As the program's options have it, or None where it is not set."""
        name, kind = python_name(option["flag"]), kind_of(option)
        if parameters.get(name) is None or (isinstance(parameters[name], QVariant) and parameters[name].isNull()):
            return None
        if kind == "boolean" and isinstance(self.parameterDefinition(name), QgsProcessingParameterEnum):
            value = self.parameterAsEnumString(parameters, name, context)
            return value == "yes" if value else None
        if kind == "boolean":
            value = self.parameterAsBool(parameters, name, context)
        elif "choices" in option:
            several = option["type"] == "texts"
            value = self.parameterAsEnumStrings(parameters, name, context) if several else self.parameterAsEnumString(parameters, name, context)
        elif kind == "integer":
            value = int(self.parameterAsDouble(parameters, name, context))  # a seed may have more than 31 bits
        elif kind == "number":
            value = self.parameterAsDouble(parameters, name, context)
        elif kind == "paths" and is_raster(option):
            value = self._rasters(parameters, name, context)
        elif kind == "path" and is_raster(option):
            value = (self._rasters(parameters, name, context) or [""])[0]
        elif option["name"] in MORE_OUTPUTS.get(self.command["word"], ()):
            value = self.parameterAsFileOutput(parameters, name, context)
        elif kind == "path":
            value = self.parameterAsFile(parameters, name, context)
        else:
            value = self.parameterAsString(parameters, name, context)
            if kind in ("texts", "numbers", "paths"):
                value = [part.strip() for part in value.split(";" if kind == "paths" else ",") if part.strip()]
                try:
                    value = [float(part) for part in value] if kind == "numbers" else value
                except ValueError:
                    raise QgsProcessingException(f"{label_of(option)}: \"{', '.join(value)}\" is no list of numbers, as 1, 2, 3") from None
        return None if value in ("", []) else value

    def _arguments(self, parameters, context):
        given = {}
        for name, several, _ in inputs_of(self.command):
            value = (self._rasters(parameters, name, context) if several and name == "raster"
                     else self.parameterAsFile(parameters, name, context))
            given[name] = value or None
        for _, options in sections_of(self.command):
            for option in options:
                if option["name"] not in LEFT_OUT:
                    given[python_name(option["flag"])] = self._value_of(option, parameters, context)
        if self.command["output"]["kind"] == "folder":
            given["output"] = self.parameterAsString(parameters, "output", context)
        else:
            output = pathlib.Path(self.parameterAsFileOutput(parameters, "output", context))
            given["output"] = str(output if output.suffix else output.with_suffix(OUTPUT_SUFFIXES[self.command["word"]]))
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
            result = run_command(self.spec, {**given, "progress": progress})
        except Interrupted:
            return {}
        except GateNotMet as unmet:
            feedback.reportError(str(unmet))
            result = unmet.result
        except Exception as error:
            raise QgsProcessingException(str(error)) from error
        feedback.pushCommandInfo(shlex.join(result.command))
        for warning in result.get("warnings", []):
            feedback.pushWarning(in_words_of_python(warning, self.spec))
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
        if not layer.isValid() or not layer.isSpatial():  # tables of what stands in the log
            return
        context.temporaryLayerStore().addMapLayer(layer)
        details = QgsProcessingContext.LayerDetails(layer.name(), context.project(), layer.name())
        details.setPostProcessor(ShownAsStored.create())
        context.addLayerToLoadOnCompletion(layer.id(), details)
