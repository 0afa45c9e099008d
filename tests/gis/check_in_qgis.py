#!/usr/bin/python3
"""Opens the files of a report or of a survey in QGIS's own library and checks that each comes up styled and draws what it means.

check_in_qgis.py FOLDER [PICTURES]: with PICTURES, a folder, also draws them there, to be looked at.
"""
import math
import os
import sys

from qgis.core import (Qgis, QgsApplication, QgsExpressionContext, QgsMapRendererSequentialJob, QgsMapSettings,
                       QgsRasterLayer, QgsVectorLayer)
from qgis.PyQt.QtCore import QSize
from qgis.PyQt.QtGui import QColor

problems = []
CLASSES = ["go", "marginal", "no-go"]


def check(what, found, expected):
    if found != expected:
        problems.append(f"{what}: {found!r}, expected {expected!r}")


def vector_layer(file, name, labels):
    layer = QgsVectorLayer(f"{file}|layername={name}", name, "ogr")
    check(f"{name} opens", layer.isValid(), True)
    check(f"{name}: renderer", layer.renderer().type(), "RuleRenderer")
    check(f"{name}: legend", [item.label() for item in layer.renderer().legendSymbolItems()], labels)
    for rule in layer.renderer().rootRule().children():
        check(f"{name}: filter of {rule.label()}", rule.filter() is None or not rule.filter().hasParserError(), True)
    return layer


def range_of_ground(file):
    """What colours span: from the 2nd to the 98th percentile (nearest rank) of P(correct fix)."""
    tiles = QgsVectorLayer(f"{file}|layername=tiles", "tiles", "ogr")
    values = sorted(value for value in (feature["p_correct_fix"] for feature in tiles.getFeatures()) if isinstance(value, float))
    low, high = (values[max(math.ceil(share * len(values)), 1) - 1] for share in (0.02, 0.98))
    check("the ground spans a tenth, else its colours would be wider", high - low >= 0.1, True)
    return low, high


def tile_layer(file, more_labels):
    low, high = range_of_ground(file)
    edges = [f"{low + (high - low) * i / 5:.2f}" for i in range(1, 5)]
    classes = [f"below {edges[0]}", *(f"{a} – {b}" for a, b in zip(edges, edges[1:])), f"from {edges[-1]}"]
    tiles = vector_layer(file, "tiles", [f"P(correct fix) {text}" for text in classes] + ["P(correct fix): not known"] + more_labels)
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
    return tiles


def report_vectors(file):
    tiles = tile_layer(file, ["matching area"])
    return [vector_layer(file, "route", ["route"]), vector_layer(file, "legs", ["good", "marginal", "bad"]),
            vector_layer(file, "gaps", [f"without a fix, {status}" for status in ("good", "marginal", "bad")]), vector_layer(file, "areas", [""]),
            tiles, vector_layer(file, "decision", CLASSES)]


def survey_vectors(file):
    return [vector_layer(file, "squares", [""]), tile_layer(file, []), vector_layer(file, "decision", CLASSES)]


def heat_map(folder, name, spanned):
    layer = QgsRasterLayer(f"{folder}/{name}", name)
    check(f"{name} opens", layer.isValid(), True)
    renderer = layer.renderer()
    check(f"{name}: renderer", renderer.type(), "singlebandpseudocolor")
    check(f"{name}: band", layer.bandName(renderer.band()).split(": ")[1], "p_correct_fix")
    drawn = renderer.classificationMin(), renderer.classificationMax()
    check(f"{name}: range", [round(value, 4) for value in drawn], [round(value, 4) for value in spanned])
    shader = renderer.shader().rasterShaderFunction()
    items = shader.colorRampItemList()
    check(f"{name}: colours", (len(items), items[0].color.name(), items[-1].color.name()), (33, "#f4f1ea", "#003262"))
    check(f"{name}: interpolated", shader.colorRampType(), shader.Interpolated)
    check(f"{name}: colour ramp", shader.sourceColorRamp().color1().name(), "#f4f1ea")
    check(f"{name}: legend", shader.legendSettings().maximumLabel(), f"{spanned[1]:.2f} P(correct fix)")
    return layer


def class_raster(folder, name):
    layer = QgsRasterLayer(f"{folder}/{name}", name)
    check(f"{name} opens", layer.isValid(), True)
    check(f"{name}: renderer", layer.renderer().type(), "paletted")
    check(f"{name}: classes", [(entry.value, entry.label) for entry in layer.renderer().classes()],
          [(float(number), name) for number, name in enumerate(CLASSES)])
    return layer


def picture(layers):
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
    return job.renderedImage(), extent


def check_drawn(decision):
    """Within each area the map shows the colour of its class. Of tiles of one level, which do not lie over each other."""
    image, extent = picture([decision])
    symbols = {rule.label(): rule.symbol() for rule in decision.renderer().rootRule().children()}
    check("decision: colours of classes", sorted(symbols), sorted(CLASSES))
    per_pixel = max(extent.width() / image.width(), extent.height() / image.height())
    seen = {name: 0 for name in CLASSES}
    for feature in decision.getFeatures():
        middle = feature.geometry().poleOfInaccessibility(1)[0].asPoint()
        x = round(image.width() / 2 + (middle.x() - extent.center().x()) / per_pixel)
        y = round(image.height() / 2 - (middle.y() - extent.center().y()) / per_pixel)
        symbol = symbols[feature["class"]]
        drawn, meant = image.pixelColor(x, y), symbol.color()
        opacity = meant.alphaF() * symbol.opacity() * decision.opacity()  # over white
        expected = [255 + (channel - 255) * opacity for channel in (meant.red(), meant.green(), meant.blue())]
        if all(abs(a - b) < 24 for a, b in zip((drawn.red(), drawn.green(), drawn.blue()), expected)):
            seen[feature["class"]] += 1
        else:
            problems.append(f"decision at {middle.x():.0f}, {middle.y():.0f}: drawn {drawn.name()}, its class {feature['class']} is {meant.name()}")
    check("decision: something is drawn", sum(seen.values()) > 0, True)
    return seen


def main():
    folder = sys.argv[1]
    application = QgsApplication([], False)  # keeps the library alive
    application.initQgis()
    is_survey = os.path.exists(f"{folder}/survey.gpkg")
    stem = "survey" if is_survey else "report"
    layers = (survey_vectors if is_survey else report_vectors)(f"{folder}/{stem}.gpkg")
    heat = heat_map(folder, f"{stem}_scores.tif", range_of_ground(f"{folder}/{stem}.gpkg"))
    classes = class_raster(folder, f"{stem}_classes.tif")
    seen = check_drawn(layers[-1]) if is_survey else None
    if len(sys.argv) > 2:
        for name, shown in (("layers", layers), ("decision", layers[-1:]), ("heat", layers[:-2] + [heat]), ("classes", [classes])):
            picture(shown)[0].save(f"{sys.argv[2]}/{stem}_{name}.png")
    print("\n".join(problems[:20]) or f"checked in QGIS {Qgis.QGIS_VERSION}" + (f": areas drawn in the colour of their class: {seen}" if seen else ""), flush=True)
    os._exit(1 if problems else 0)  # QGIS and Python do not always agree on who goes first


main()
