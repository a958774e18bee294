"""Names of the public API, for type checkers and editors; ``__init__.py`` loads them when asked for."""

from seal_mdao.analysis.newton import NewtonOptions as NewtonOptions
from seal_mdao.analysis_cache import AnalysisCache as AnalysisCache
from seal_mdao.components.area_comp import AreaComp as AreaComp
from seal_mdao.components.failures import (
    UntrustworthyResultWarning as UntrustworthyResultWarning,
)
from seal_mdao.components.rkpm_contact_comp import RkpmContactComp as RkpmContactComp
from seal_mdao.components.scenario_group import ScenarioGroup as ScenarioGroup
from seal_mdao.components.seal_group import SealGroup as SealGroup
from seal_mdao.components.spline_geometry_comp import SplineGeometryComp as SplineGeometryComp
from seal_mdao.contact.friction_law import FrictionLaw as FrictionLaw
from seal_mdao.contact.friction_law import friction_law as friction_law
from seal_mdao.drivers.ipopt_driver import IpoptDriver as IpoptDriver
from seal_mdao.drivers.slsqp_driver import SlsqpDriver as SlsqpDriver
from seal_mdao.drivers.uno_driver import UnoDriver as UnoDriver
from seal_mdao.dsa.sensitivity import Sensitivities as Sensitivities
from seal_mdao.dsa.sensitivity import differentiate as differentiate
from seal_mdao.errors import GeometryError as GeometryError
from seal_mdao.errors import KinkWarning as KinkWarning
from seal_mdao.errors import LoadPathError as LoadPathError
from seal_mdao.errors import SealFileError as SealFileError
from seal_mdao.errors import TooLargeError as TooLargeError
from seal_mdao.file_seal import build_seal as build_seal
from seal_mdao.materials.gent import Gent as Gent
from seal_mdao.materials.hyperfoam import Hyperfoam as Hyperfoam
from seal_mdao.materials.mooney_rivlin import MooneyRivlin as MooneyRivlin
from seal_mdao.materials.neo_hookean import NeoHookean as NeoHookean
from seal_mdao.materials.ogden import Ogden as Ogden
from seal_mdao.materials.yeoh import Yeoh as Yeoh
from seal_mdao.recording.recorder import RestartRecorder as RestartRecorder
from seal_mdao.recording.restart import restart as restart
from seal_mdao.registry import register as register
from seal_mdao.scenarios.variation import Scenarios as Scenarios
from seal_mdao.scenarios.variation import Variation as Variation
from seal_mdao.seals.door.door_seal import door_seal as door_seal
from seal_mdao.seals.door.section import Section as Section
from seal_mdao.seals.file.file_tables import SealFile as SealFile
from seal_mdao.seals.file.read import read_seal_file as read_seal_file
from seal_mdao.seals.outline.contours import Outline as Outline
from seal_mdao.seals.outline.dxf import read_dxf as read_dxf
from seal_mdao.seals.outline.dxf import write_dxf as write_dxf
from seal_mdao.seals.result import SealResult as SealResult
from seal_mdao.seals.result import analyze as analyze
from seal_mdao.seals.result import estimate as estimate
from seal_mdao.seals.seal import Seal as Seal

__version__: str
