#!/usr/bin/python3
"""Opens the files of a report in QGIS's own library and checks that each comes up styled.

check_in_qgis.py FOLDER [PICTURES]: with PICTURES, a folder, also draws them there, to be looked at.
"""
import os
import sys

from qgis.core import (Qgis, QgsApplication, QgsExpressionContext, QgsMapRendererSequentialJob, QgsMapSettings,
                       QgsRasterLayer, QgsVectorLayer)
from qgis.PyQt.QtCore import QSize
from qgis.PyQt.QtGui import QColor

problems = []


def check(what, found, expected):
    if found != expected:
        problems.append(f"{what}: {found!r}, expected {expected!r}")


def vector_layer(folder, name, labels):
    layer = QgsVectorLayer(f"{folder}/report.gpkg|layername={name}", name, "ogr")
    check(f"{name} opens", layer.isValid(), True)
    check(f"{name}: renderer", layer.renderer().type(), "RuleRenderer")
    check(f"{name}: legend", [item.label() for item in layer.renderer().legendSymbolItems()], labels)
    for rule in layer.renderer().rootRule().children():
        check(f"{name}: filter of {rule.label()}", rule.filter() is None or not rule.filter().hasParserError(), True)
    return layer


def vectors(folder):
    classes = [f"P(correct fix) {low:.2f} – {low + 0.2:.2f}" for low in (0, 0.2, 0.4, 0.6, 0.8)]
    tiles = vector_layer(folder, "tiles", classes + ["P(correct fix): not known", "matching area"])
    names = [field.name() for field in tiles.fields()]
    check("alias", tiles.attributeAlias(names.index("p_correct_fix")), "P(correct fix)")
    check("alias with unit", tiles.attributeAlias(names.index("relief_m")), "Highest minus lowest ground [m]")
    rules = tiles.renderer().rootRule().children()[:6]  # every tile is in one class
    for feature in tiles.getFeatures():
        context = QgsExpressionContext()
        context.setFeature(feature)
        context.setFields(tiles.fields())
        hits = sum(1 for rule in rules if rule.filter().evaluate(context))
        check(f"classes of tile {feature['tile_id']}", hits, 1)
    return [vector_layer(folder, "route", ["route"]), vector_layer(folder, "legs", ["good", "marginal", "bad"]),
            vector_layer(folder, "gaps", [f"without a fix, {status}" for status in ("good", "marginal", "bad")]), vector_layer(folder, "areas", [""]), tiles,
            vector_layer(folder, "decision", ["go", "marginal", "no-go"])]


def heat_map(folder, name):
    layer = QgsRasterLayer(f"{folder}/{name}", name)
    check(f"{name} opens", layer.isValid(), True)
    renderer = layer.renderer()
    check(f"{name}: renderer", renderer.type(), "singlebandpseudocolor")
    check(f"{name}: band", layer.bandName(renderer.band()).split(": ")[1], "p_correct_fix")
    check(f"{name}: range", (renderer.classificationMin(), renderer.classificationMax()), (0.0, 1.0))
    shader = renderer.shader().rasterShaderFunction()
    items = shader.colorRampItemList()
    check(f"{name}: colours", (len(items), items[0].color.name(), items[-1].color.name()), (33, "#440154", "#fde725"))
    check(f"{name}: interpolated", shader.colorRampType(), shader.Interpolated)
    check(f"{name}: colour ramp", shader.sourceColorRamp().color1().name(), "#440154")
    check(f"{name}: legend", shader.legendSettings().maximumLabel(), "1.00 P(correct fix)")
    return layer


def class_raster(folder, name):
    layer = QgsRasterLayer(f"{folder}/{name}", name)
    check(f"{name} opens", layer.isValid(), True)
    check(f"{name}: renderer", layer.renderer().type(), "paletted")
    check(f"{name}: classes", [(entry.value, entry.label) for entry in layer.renderer().classes()],
          [(0.0, "go"), (1.0, "marginal"), (2.0, "no-go")])
    return layer


def draw(layers, path):
    settings = QgsMapSettings()
    settings.setLayers(layers)
    settings.setBackgroundColor(QColor("white"))
    settings.setOutputSize(QSize(1100, 800))
    settings.setDestinationCrs(layers[-1].crs())
    extent = layers[-1].extent()
    extent.scale(1.1)
    settings.setExtent(extent)
    job = QgsMapRendererSequentialJob(settings)
    job.start()
    job.waitForFinished()
    job.renderedImage().save(path)


def main():
    folder = sys.argv[1]
    application = QgsApplication([], False)  # keeps the library alive
    application.initQgis()
    layers = vectors(folder)
    heat = heat_map(folder, "report_scores.tif")
    classes = class_raster(folder, "report_classes.tif")
    if len(sys.argv) > 2:
        draw(layers, f"{sys.argv[2]}/layers.png")
        draw(layers[:3] + [heat], f"{sys.argv[2]}/heat.png")
        draw([classes], f"{sys.argv[2]}/classes.png")
    print("\n".join(problems) or f"checked in QGIS {Qgis.QGIS_VERSION}", flush=True)
    os._exit(1 if problems else 0)  # QGIS and Python do not always agree on who goes first


main()
