#!/usr/bin/python3
"""The plugin as QGIS runs it, without windows: plugin_check.py PLUGIN_FOLDER SMALL_MISSION, in an empty working folder.

Ends with "checked in QGIS 3…"; what is wrong is said before."""

import json
import os
import pathlib
import sys

plugins, mission = sys.argv[1:3]
sys.path[:0] = [plugins, "/usr/share/qgis/python/plugins"]

from processing.core.Processing import Processing
from processing.core.ProcessingConfig import ProcessingConfig
from qgis.core import (Qgis, QgsApplication, QgsProcessingContext, QgsProcessingFeedback, QgsProcessingParameterDefinition,
                       QgsProject, QgsRasterLayer)
from qgis.PyQt.QtCore import QVariant

import pilotage_processing

problems = []
OF_THE_RUN = {"overwrite", "threads", "seed", "allow_network", "allow_any_vrt"}


def check(what, found, expected):
    if found != expected:
        problems.append(f"{what}: {found!r}, expected {expected!r}")


class Feedback(QgsProcessingFeedback):
    """Remembers what it is told, and cancels when `cancel_at` is what is done."""

    def __init__(self, cancel_at=None):
        super().__init__(False)
        self.cancel_at, self.texts, self.shares, self.said, self.commands = cancel_at, [], [], [], []
        self.progressChanged.connect(self.shares.append)

    def setProgressText(self, text):
        self.texts.append(text)
        if text == self.cancel_at:
            self.cancel()

    def pushInfo(self, info):
        self.said.append(info)

    def pushCommandInfo(self, info):
        self.commands.append(info)

    def pushWarning(self, warning):
        self.said.append(warning)

    def reportError(self, error, fatalError=False):
        self.said.append(error)


def run(algorithm, parameters, feedback=None):
    context = QgsProcessingContext()
    context.setProject(QgsProject.instance())
    feedback = feedback or Feedback()
    results, done = algorithm.create().run(parameters, context, feedback)
    return results, done, context, feedback


def loaded(context, feedback):
    """The layers that come up when the algorithm has ended, as QGIS's own windows do it."""
    layers = {}
    for layer_id, details in context.layersToLoadOnCompletion().items():
        layer = context.temporaryLayerStore().mapLayer(layer_id)
        details.postProcessor().postProcessLayer(layer, context, feedback)
        layers[details.name] = layer
    return layers


def check_parameters(provider):
    score = provider.algorithm("score")
    size = score.parameterDefinition("tile_size_px")
    check("tile_size_px", (size.type(), size.minimum(), size.maximum()), ("number", 2, 4096))
    check("tile_size_px is plain", bool(size.flags() & QgsProcessingParameterDefinition.FlagAdvanced), False)
    check("threads is advanced", bool(score.parameterDefinition("threads").flags() & QgsProcessingParameterDefinition.FlagAdvanced), True)
    check("measures", score.parameterDefinition("measures").allowMultiple(), True)
    prepare = provider.algorithm("prepare")
    check("ins_grade", "tactical" in prepare.parameterDefinition("ins_grade").options(), True)
    check("elevation", prepare.parameterDefinition("elevation").type(), "raster")
    check("imagery", prepare.parameterDefinition("imagery").type(), "multilayer")
    check("route", prepare.parameterDefinition("route").type(), "file")
    check("nothing is set beside a mission file", [parameter.name() for parameter in prepare.parameterDefinitions()
                                                   if parameter.defaultValue() is not None and parameter.name() not in OF_THE_RUN], [])
    check("defaults are told", "Default: 3.0." in prepare.parameterDefinition("wind_sigma_mps").help(), True)
    check("defaults are shown where there is no file", score.parameterDefinition("min_valid_fraction").defaultValue(), 0.5)
    check("second date", prepare.parameterDefinition("second_epoch").type(), "multilayer")
    check("table is an output", score.parameterDefinition("table").isDestination(), True)
    check("of one machine", [name for name in ("shard", "shards", "plan_shards") if score.parameterDefinition(name)], [])
    check("no parameter of the terminal", [name for name in ("quiet", "print_config", "json") if prepare.parameterDefinition(name)], [])
    for algorithm in provider.algorithms():
        check(f"{algorithm.name()} has help", len(algorithm.shortHelpString()) > 500, True)
        check(f"{algorithm.name()}: not of a terminal", "Exit with" in algorithm.shortHelpString(), False)


def check_score(provider):
    results, done, context, feedback = run(provider.algorithm("score"), {
        "raster": [f"{mission}/ortho.tif"], "tile_size_px": 128, "stride_px": 64, "measures": ["gray_variance", "frieden_entropy"],
        "seed": 1 << 40, "table": os.path.abspath("tiles.csv"), "output": os.path.abspath("scores.tif")})
    check("score", done, True)
    check("options are given", json.loads(results["result"])["output"], os.path.abspath("scores.tif"))
    check("nothing is written beside the imagery", os.path.exists(f"{mission}/ortho.tif.aux.xml"), False)
    check("the table", os.path.exists("tiles.csv"), True)
    check("a seed of 40 bits", f"--seed={1 << 40}" in feedback.commands[0], True)
    layers = loaded(context, feedback)
    check("layers of score", list(layers), ["scores"])
    check("style of score", layers["scores"].renderer().type(), "singlebandpseudocolor")
    check("bands of score", layers["scores"].bandCount(), 4)
    _, done, _, other = run(provider.algorithm("score"), {"raster": [f"{mission}/ortho.tif"], "gsd_m": QVariant(QVariant.Double),
                                                             "measures": ["gray_variance"], "output": os.path.abspath("null.tif")})
    check("what is null is not set", (done, "gsd" in other.commands[0]), (True, False))


def check_survey(provider):
    imagery = QgsRasterLayer(f"{mission}/ortho.tif", "imagery of the project")
    QgsProject.instance().addMapLayer(imagery)
    results, done, context, feedback = run(provider.algorithm("survey"), {
        "raster": [imagery], "elevation": f"{mission}/elevation.tif", "camera_hfov_deg": 73.7, "camera_width_px": 1000, "camera_height_px": 562,
        "agl_m": 60, "output": os.path.abspath("area")})
    check("survey", done, True)
    check("headline", "a fix may be expected" in results["headline"], True)
    check("headline is said", results["headline"] in feedback.said, True)
    check("what it does not look at is said", any("obstacles" in said for said in feedback.said), True)
    check("progress grows to its end", (feedback.shares == sorted(feedback.shares), feedback.shares[-1] > 66), (True, True))
    check("progress says what", "score" in feedback.texts, True)
    layers = loaded(context, feedback)
    for name in ("survey: tiles", "survey: decision", "survey: squares"):
        check(f"{name} has its style", layers[name].renderer().type() if name in layers else sorted(layers), "RuleRenderer")
    check("tables do not", [name for name, layer in layers.items() if not layer.isSpatial()], [])
    check("heat maps come up", any(name.startswith("survey_") for name in layers), True)


def check_prepare(provider):
    results, done, context, feedback = run(provider.algorithm("prepare"), {
        "mission": f"{mission}/mission.json", "ins_grade": "consumer", "require": True, "flights": 0, "output": os.path.abspath("out")})
    check("prepare of a gate that is not met", done, True)
    check("verdict", results["headline"].split(":")[0], "NO-GO")
    check("verdict is an error", results["headline"] in feedback.said, True)
    check("map", os.path.exists("out/map.gpkg"), True)
    check("only what is set is given", json.loads(results["result"])["selected_tiles"] > 0, True)
    given = [said for said in feedback.commands if said.startswith("/") and " prepare " in said][0]
    check("no default is given", [word for word in ("--wind-sigma-mps", "--measures", "--chips") if word in given], [])
    results, done, _, feedback = run(provider.algorithm("prepare"), {
        "mission": f"{mission}/mission.json", "chips": "yes", "sparse": "no", "wind_sigma_mps": 3, "flights": 0, "output": os.path.abspath("set")})
    given = feedback.commands[0]
    check("what is set to the default is given", [word for word in ("--wind-sigma-mps=3.0", "--chips=true", "--sparse=false") if word not in given], [])
    layers = loaded(context, feedback)
    check("scores come up", "scores" in layers, True)
    check("report comes up", "report: route" in layers, True)
    check("the onboard map does not", [name for name in layers if name.startswith("map")], [])
    os.makedirs("again")
    results, done, _, _ = run(provider.algorithm("report"), {
        "input": os.path.abspath("out"), "report_json": os.path.abspath("again/numbers.json"), "output": os.path.abspath("again/report")})
    check("report", (done, os.path.exists("again/report.html"), os.path.exists("again/numbers.json")), (True, True, True))
    check("verdict of the report", results["headline"].split(":")[0], "NO-GO")


def check_refusals(provider):
    _, done, _, feedback = run(provider.algorithm("survey"), {"raster": [f"{mission}/ortho.tif"], "camera_hfov_deg": 73.7, "camera_width_px": 1000,
                                                             "camera_height_px": 562, "output": os.path.abspath("none")})
    check("survey without a height", (done, any("agl_m" in said for said in feedback.said)), (False, True))
    _, done, _, feedback = run(provider.algorithm("score"), {"raster": [f"{mission}/ortho.tif"], "bands": "1, x",
                                                             "output": os.path.abspath("none.tif")})
    check("bands that are none", (done, any("is no list of numbers" in said for said in feedback.said)), (False, True))
    before = sorted(path for path in pathlib.Path(".").rglob("*") if path.is_file())
    _, _, context, feedback = run(provider.algorithm("prepare"), {"mission": f"{mission}/mission.json", "output": os.path.abspath("cancelled")},
                                  Feedback(cancel_at="score"))
    check("cancelled", feedback.isCanceled(), True)
    check("nothing is left", [path for path in pathlib.Path(".").rglob("*") if path.is_file() and path not in before], [])
    check("nothing comes up", context.layersToLoadOnCompletion(), {})


def check_setting(provider):
    ProcessingConfig.setSettingValue("PILOTAGE_PROGRAM", os.path.abspath("scores.tif"))
    provider.refreshAlgorithms()
    check("without a program there is no algorithm", provider.algorithms(), [])
    ProcessingConfig.setSettingValue("PILOTAGE_PROGRAM", "")
    provider.refreshAlgorithms()
    check("and with one again", len(provider.algorithms()), 5)


application = QgsApplication([], False)
application.initQgis()
Processing.initialize()
plugin = pilotage_processing.classFactory(None)
plugin.initProcessing()
provider = QgsApplication.processingRegistry().providerById("pilotage")
check("algorithms", sorted(algorithm.id() for algorithm in provider.algorithms()),
      [f"pilotage:{word}" for word in ("prepare", "report", "reroute", "score", "survey")])
if not problems:
    for one in (check_parameters, check_score, check_survey, check_prepare, check_refusals, check_setting):
        one(provider)
plugin.unload()
check("unloaded", QgsApplication.processingRegistry().providerById("pilotage"), None)
for problem in problems:
    print(problem)
if not problems:
    print(f"checked in QGIS {Qgis.QGIS_VERSION}", flush=True)
os._exit(bool(problems))  # QGIS's own clean-up without windows may end in a signal
