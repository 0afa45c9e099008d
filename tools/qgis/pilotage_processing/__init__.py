"""Plugin for QGIS: algorithms of the Processing toolbox that run the program `pilotage`."""


def classFactory(iface):  # QGIS calls it by this name
    from .plugin import Plugin

    return Plugin()
