"""A seal file from a stranger names any file of the machine: none is shown, none is read without end."""

import os
import re
from pathlib import Path

import pytest

import seal_mdao as sm
from seal_mdao.input_files import LARGEST_FILE

BULB = (Path(__file__).parent / "bulb.toml").read_text()
MATERIAL = BULB[: BULB.index("[section]")]
SHAPE = BULB[BULB.index("spacing = 0.9") : BULB.index("[fixed]")]
WORDS = ("hunter2", "secret", "4711")
SECRETS = {
    "passwords": "root:hunter2:0:0:secret,4711\n",
    "table": "user,mode,stretch\nsecret,hunter2,4711\n",
    "number": "4711\nhunter2 secret\n",
    "markup": "<secret hunter2='4711'>&hunter2;\n",
    "xml": "<secret hunter2='4711'/>\n",
    "settings": "[secret]\nhunter2 = 4711\n",
    "groups": "  0\nSECTION\n  2\nHEADER\n  9\n$secret\nhunter2\n4711\n",
    "mesh": "$MeshFormat\n4711 secret hunter2\n$EndMeshFormat\n",
    "include": "*NODE\n*INCLUDE, INPUT=secret-hunter2-4711.inp\n",
    "polygons": "OFF\n4711 hunter2 secret\n",
    "vtk": "# vtk DataFile Version 4711\nsecret\nhunter2\nsecret\n",
    "bytes": b"\x00\x01secret\xff\xfehunter2 4711",
}
MESHES = (
    ".vtu", ".vtk", ".msh", ".inp", ".off", ".stl", ".obj", ".svg", ".xdmf", ".bdf", ".mesh", ".su2",
    ".txt", "",
)  # fmt: skip


def naming(key, name):
    """A seal file whose data, drawing or cloud has a name."""
    if key == "data":
        return BULB.replace(MATERIAL, f'[material.rubber]\nlaw = "yeoh"\ndata = "{name}"\n')
    if key == "dxf":
        return BULB.replace(SHAPE, f'spacing = 0.9\ndxf = "{name}"\n')
    return BULB.replace("spacing = 0.9", f'cloud = "{name}"')


def refused(folder, key, name):
    path = folder / "seal.toml"
    path.write_text(naming(key, name))
    with pytest.raises(sm.SealFileError) as caught:
        sm.read_seal_file(path)
    text = str(caught.value)
    assert text.startswith(f"{path}: ")
    assert "\n" not in text
    assert Path(name).name in text
    return text


@pytest.mark.parametrize("secret", SECRETS)
@pytest.mark.parametrize("key", ["data", "dxf", "cloud"])
def test_nothing_of_another_file_is_shown(tmp_path, capfd, key, secret):
    content = SECRETS[secret]
    for ending in MESHES if key == "cloud" else ("",):
        path = tmp_path / f"other{ending}"
        path.write_bytes(content if isinstance(content, bytes) else content.encode())
        said = [refused(tmp_path, key, path.name), *capfd.readouterr()]
        assert not [word for word in WORDS for text in said if word in text]


@pytest.mark.skipif(not hasattr(os, "mkfifo"), reason="the system has no pipes with names")
@pytest.mark.parametrize("key", ["data", "dxf", "cloud"])
def test_endless_files_are_not_read(tmp_path, key):
    """A device, a link to it, a pipe into which nobody writes."""
    (tmp_path / "zero.vtu").symlink_to("/dev/zero")
    os.mkfifo(tmp_path / "pipe.vtu")
    for name in ("/dev/zero", "zero.vtu", "pipe.vtu"):
        text = refused(tmp_path, key, name)
        assert re.search("is a device or a pipe|there is no such", text)


@pytest.mark.parametrize("key", ["data", "dxf", "cloud"])
def test_files_larger_than_any_drawing_are_not_read(tmp_path, key):
    with (tmp_path / "large.vtu").open("wb") as file:
        file.truncate(LARGEST_FILE + 1)
    assert "is larger than the limit of 256 MiB" in refused(tmp_path, key, "large.vtu")


@pytest.mark.skipif(not hasattr(os, "mkfifo"), reason="the system has no pipes with names")
def test_seal_file_that_is_endless(tmp_path):
    os.mkfifo(tmp_path / "pipe.toml")
    (tmp_path / "zero.toml").symlink_to("/dev/zero")
    for name in ("pipe.toml", "zero.toml"):
        with pytest.raises(sm.SealFileError, match="it is a device or a pipe, not a file"):
            sm.read_seal_file(tmp_path / name)


@pytest.mark.parametrize("name", ["other.xdmf", "other.XMF", "other.inp"])
def test_mesh_in_several_files_is_refused(tmp_path, name):
    (tmp_path / name).write_text("*IN*CLUDE, INPUT=/dev/zero\n")
    assert "the mesh file (cloud) refers to other files, which" in refused(tmp_path, "cloud", name)


NUMBERS = [match.span() for match in re.finditer(r"(?<![\w.])-?\d+(\.\d+)?", BULB)]
HUGE = {
    "400 digits": "9" * 400, "negative": "-" + "9" * 400, "5000 digits": "9" * 5000,
    "hexadecimal": "0x" + "f" * 5000, "list": f"[{'9' * 400}]", "hexadecimal list": f"[0x{'f' * 5000}]",
}  # fmt: skip


@pytest.mark.parametrize("huge", HUGE)
def test_integers_of_400_digits(tmp_path, huge):
    """In the place of every number of a file."""
    assert len(NUMBERS) > 30
    path = tmp_path / "seal.toml"
    for start, end in NUMBERS:
        path.write_text(BULB[:start] + HUGE[huge] + BULB[end:])
        with pytest.raises(sm.SealFileError) as caught:
            sm.read_seal_file(path)
        assert "\n" not in str(caught.value)
        assert len(str(caught.value)) < 600
