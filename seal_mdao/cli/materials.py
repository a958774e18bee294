"""List the materials that need no constants: dense rubber by its hardness, foam by its grade."""

from seal_mdao.cli.arguments import parser
from seal_mdao.materials.by_name import LAWS
from seal_mdao.materials.material_lists import LISTS


def main(arguments) -> int:
    for made in LISTS:
        found = made()
        print(f"{found.title}\n")
        # columns as wide as their widest entry
        widths = [max(map(len, column)) for column in zip(found.head, *found.rows, strict=True)]
        for row in (found.head, *found.rows):
            print("  " + "  ".join(f"{cell:>{w}}" for cell, w in zip(row, widths, strict=True)))
        print("\n" + "\n".join(f"  {note}" for note in found.notes) + "\n")
    print(f"laws with constants (given, or fitted to tests): law = {', '.join(LAWS)}")
    return 0


def arguments_parser():
    return parser(__doc__, ".", "", "seal-mdao materials > rubbers.txt")
