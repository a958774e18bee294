"""Material laws by their names in seal files and on the command line."""

from seal_mdao.materials.gent import Gent
from seal_mdao.materials.hyperfoam import Hyperfoam
from seal_mdao.materials.mooney_rivlin import MooneyRivlin
from seal_mdao.materials.neo_hookean import NeoHookean
from seal_mdao.materials.ogden import Ogden
from seal_mdao.materials.yeoh import Yeoh

LAWS = {
    "neo_hookean": NeoHookean,
    "mooney_rivlin": MooneyRivlin,
    "yeoh": Yeoh,
    "gent": Gent,
    "ogden": Ogden,
    "hyperfoam": Hyperfoam,
}
"""Class of every law."""
