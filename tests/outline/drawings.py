"""Drawings made with ezdxf, for tests."""

import ezdxf


class Drawing:
    """A drawing in a folder; ``units`` as $INSUNITS, None for none at all."""

    def __init__(self, folder, units=4, version="R2010"):
        self.path, self.units = folder / "drawing.dxf", units
        self.document = ezdxf.new(version, units=units or 0)
        self.model = self.document.modelspace()

    def box(self, size=10.0, layer="seal", at=(0.0, 0.0)):
        """A closed square."""
        x, y = at
        corners = [(x, y), (x + size, y), (x + size, y + size), (x, y + size)]
        self.model.add_lwpolyline(corners, close=True, dxfattribs={"layer": layer})
        return self

    def saved(self):
        self.document.saveas(self.path)
        if self.units is None:
            lines = self.path.read_text().splitlines()
            at = lines.index("$INSUNITS")
            del lines[at - 1 : at + 3]
            self.path.write_text("\n".join(lines) + "\n")
        return self.path
