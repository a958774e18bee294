"""Shape sensitivities and optimisation of frictional rubber-seal contact for OpenMDAO.

The numerics import nothing from OpenMDAO; its components are loaded when they are first asked for.
"""

from importlib import import_module

from seal_mdao._version import __version__

_LAZY = {
    "door_seal": "seal_mdao.seals.door.door_seal",
    "Seal": "seal_mdao.seals.seal",
    "SealResult": "seal_mdao.seals.result",
    "analyze": "seal_mdao.seals.result",
    "estimate": "seal_mdao.seals.result",
    "AnalysisCache": "seal_mdao.analysis_cache",
    "Sensitivities": "seal_mdao.dsa.sensitivity",
    "differentiate": "seal_mdao.dsa.sensitivity",
    "NeoHookean": "seal_mdao.materials.neo_hookean",
    "MooneyRivlin": "seal_mdao.materials.mooney_rivlin",
    "Yeoh": "seal_mdao.materials.yeoh",
    "Gent": "seal_mdao.materials.gent",
    "Ogden": "seal_mdao.materials.ogden",
    "Hyperfoam": "seal_mdao.materials.hyperfoam",
    "NewtonOptions": "seal_mdao.analysis.newton",
    "Section": "seal_mdao.seals.door.section",
    "GeometryError": "seal_mdao.errors",
    "LoadPathError": "seal_mdao.errors",
    "KinkWarning": "seal_mdao.errors",
    "SealFileError": "seal_mdao.errors",
    "SealFile": "seal_mdao.seals.file.file_tables",
    "read_seal_file": "seal_mdao.seals.file.read",
    "build_seal": "seal_mdao.file_seal",
    "Outline": "seal_mdao.seals.outline.contours",
    "read_dxf": "seal_mdao.seals.outline.dxf",
    "write_dxf": "seal_mdao.seals.outline.dxf",
    "TooLargeError": "seal_mdao.errors",
    "SplineGeometryComp": "seal_mdao.components.spline_geometry_comp",
    "AreaComp": "seal_mdao.components.area_comp",
    "UntrustworthyResultWarning": "seal_mdao.components.failures",
    "RkpmContactComp": "seal_mdao.components.rkpm_contact_comp",
    "SealGroup": "seal_mdao.components.seal_group",
    "ScenarioGroup": "seal_mdao.components.scenario_group",
    "Scenarios": "seal_mdao.scenarios.variation",
    "Variation": "seal_mdao.scenarios.variation",
    "UnoDriver": "seal_mdao.drivers.uno_driver",
    "IpoptDriver": "seal_mdao.drivers.ipopt_driver",
    "SlsqpDriver": "seal_mdao.drivers.slsqp_driver",
    "register": "seal_mdao.registry",
    "FrictionLaw": "seal_mdao.contact.friction_law",
    "friction_law": "seal_mdao.contact.friction_law",
    "RestartRecorder": "seal_mdao.recording.recorder",
    "restart": "seal_mdao.recording.restart",
}

__all__ = ["__version__", *_LAZY]


def __getattr__(name):
    if name not in _LAZY:
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    value = getattr(import_module(_LAZY[name]), name)
    globals()[name] = value
    return value


def __dir__():
    return sorted(__all__)
