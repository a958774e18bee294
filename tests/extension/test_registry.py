"""Extensions by name: entry points of installed distributions, in-process ones, and what is refused."""

import importlib
import sys
from dataclasses import replace
from pathlib import Path

import pytest

import seal_mdao as sm
from seal_mdao import registry

HERE = Path(__file__).parent
BLOCK = (HERE / "block.toml").read_text(encoding="utf-8")
GIVEN = 'friction = { law = "pressure_dependent", friction = 0.5, reference = 60.0 }'


@pytest.fixture(autouse=True)
def extensions():
    for name in ("arruda_boyce", "elastic_foundation", "ellipse", "highest_point",
                 "pressure_dependent"):  # fmt: skip
        importlib.import_module(name)


@pytest.fixture
def install(tmp_path, monkeypatch):
    """Put a distribution with a module and entry points on the path, as pip does."""
    monkeypatch.syspath_prepend(tmp_path)

    def installed(distribution, module, code, kind, *points):
        (tmp_path / f"{module}.py").write_text(code)
        info = tmp_path / f"{distribution}-1.0.dist-info"
        info.mkdir()
        (info / "METADATA").write_text(
            f"Metadata-Version: 2.1\nName: {distribution}\nVersion: 1.0\n"
        )
        lines = [f"[seal_mdao.{kind}]", *points]
        (info / "entry_points.txt").write_text("\n".join(lines))
        registry._entry_points.cache_clear()

    yield installed
    registry._entry_points.cache_clear()
    for name in [name for name in sys.modules if name.startswith("rubber_")]:
        del sys.modules[name]


def read(tmp_path, old="", new=""):
    assert old in BLOCK
    path = tmp_path / "block.toml"
    path.write_text(BLOCK.replace(old, new) if old else BLOCK)
    return sm.read_seal_file(path)


def message(tmp_path, old, new):
    with pytest.raises(sm.SealFileError) as caught:
        read(tmp_path, old, new)
    text = str(caught.value)
    assert "\n" not in text
    return text.partition("block.toml: ")[2]


LAW = "def capped(pressure, friction, most=50.0):\n    return friction * pressure\n"
CAPPED = 'friction = { law = "capped", friction = 0.4 }'


def test_a_law_of_an_installed_distribution(install, tmp_path):
    install(
        "rubber_laws", "rubber_friction", LAW, "friction_laws", "capped = rubber_friction:capped"
    )
    (profile,) = read(tmp_path, GIVEN, CAPPED).profiles
    assert profile.friction.by_name == {"friction": 0.4, "most": 50.0}
    assert profile.friction.limits.__module__ == "rubber_friction"
    assert "capped" in registry.names("friction_laws")


def test_nothing_is_imported_for_a_file_that_does_not_name_it(install, tmp_path):
    install(
        "rubber_laws", "rubber_bad", "raise RuntimeError", "friction_laws", "bad = rubber_bad:law"
    )
    read(tmp_path)
    assert "rubber_bad" not in sys.modules


def test_a_path_in_a_file_is_no_extension(tmp_path, monkeypatch):
    """What a file names is looked up among names; modules beside it are not imported."""
    (tmp_path / "rubber_evil.py").write_text("raise SystemExit")
    monkeypatch.chdir(tmp_path)
    for name in ("rubber_evil:law", "./rubber_evil.py", "rubber_evil"):
        found = message(tmp_path, '"pressure_dependent"', f'"{name}"')
        assert f"law = '{name}', but it must be one of coulomb, " in found
    assert "rubber_evil" not in sys.modules


def test_an_entry_point_that_fails_to_load_names_its_distribution(install, tmp_path):
    install("rubber_laws", "rubber_bad", "import no_such_module", "friction_laws",
            "capped = rubber_bad:capped")  # fmt: skip
    assert message(tmp_path, GIVEN, CAPPED) == (
        "[[profile]] 1 ('roll'): friction: the friction law 'capped' of the distribution "
        "'rubber_laws' cannot be loaded (ModuleNotFoundError: No module named 'no_such_module'); "
        "repair or uninstall it"
    )


def test_an_entry_point_whose_name_is_no_identifier(install, tmp_path):
    install("rubber_laws", "rubber_any", LAW, "friction_laws", "a-law = rubber_any:capped")
    found = message(tmp_path, GIVEN, CAPPED.replace("capped", "a-law"))
    assert found.endswith("the distribution 'rubber_laws' must be an identifier")


def test_names_that_clash_are_refused_with_their_distributions(install, tmp_path):
    for number in ("one", "two"):
        install(f"rubber_{number}", f"rubber_{number}_laws", LAW, "friction_laws",
                f"capped = rubber_{number}_laws:capped")  # fmt: skip
    found = message(tmp_path, GIVEN, CAPPED)
    assert "the distribution 'rubber_one'" in found
    assert "the distribution 'rubber_two'" in found
    assert found.endswith("or uninstall all of these packages but one")


@pytest.mark.parametrize(("kind", "name", "old", "new"), [
    ("materials", "yeoh", 'law = "arruda_boyce"', 'law = "yeoh"'),
    ("measures", "stress_norm", 'type = "highest_point"', 'type = "stress_norm"'),
    ("friction_laws", "coulomb", GIVEN, 'friction = { law = "coulomb", friction = 0.2 }'),
])  # fmt: skip
def test_a_name_of_the_package_itself_is_taken(install, tmp_path, kind, name, old, new):
    install("rubber_laws", "rubber_any", LAW, kind, f"{name} = rubber_any:capped")
    found = message(tmp_path, old, new)
    assert "seal_mdao itself and the distribution 'rubber_laws'" in found


@pytest.mark.parametrize(("kind", "name", "old", "words"), [
    ("materials", "odd", 'law = "arruda_boyce"', "a dataclass that derives from Isotropic"),
    ("measures", "odd", 'type = "highest_point"', "a dataclass that derives from Measure"),
    ("terms", "odd", 'type = "elastic_foundation"', "a dataclass that derives from TermDefinition"),
    ("profiles", "odd", 'type = "ellipse"', "a dataclass with names and profile()"),
])  # fmt: skip
def test_what_is_no_such_extension(install, tmp_path, kind, name, old, words):
    install("rubber_laws", "rubber_any", LAW, kind, f"{name} = rubber_any:capped")
    found = message(tmp_path, old, f'{old.split(" = ")[0]} = "{name}"')
    assert f"'odd' of the distribution 'rubber_laws' must be {words}, got capped" in found


@pytest.mark.parametrize(("old", "new", "words"), [
    ("friction = 0.5, ", "", "[[profile]] 1 ('roll'): friction: the key 'friction' is missing"),
    ("reference = 60.0", "refrence = 60.0", "unknown key 'refrence' (did you mean 'reference'?)"),
    ("reference = 60.0", 'reference = "60"', "reference = '60', but it must be a number"),
    ("reference = 60.0", "reference = -0.5", "'pressure_dependent' must return finite friction limits"),
    ("friction = 0.5, reference", "friction = -0.5, reference", "limits of at least 0 kPa"),
    ("links = 8.0", "links = -8.0", "[material.rubber]: links of ArrudaBoyce must be a number above 0"),
    ("a = 1.5, ", "", "shape: the key 'a' is missing; it must be a number"),
    ("a = 1.5", "a = -1.5", "shape: semi-axes must be positive"),
    ('edges = ["right", "left"]', 'edges = ["rigth"]', "[[term]] 1: edges = 'rigth', but there is no"),
    ('name = "springs"', 'name = "roll"', "[[term]] 1: name = 'roll', but a profile has it"),
    ("stiffness = 300.0", "", "[[term]] 1: the key 'stiffness' is missing"),
    ('type = "ellipse"', 'type = "elipse"', "shape: type = 'elipse', but it must be one of ellipse"),
    ('"elastic_foundation"', '"foundation"', "type = 'foundation', but it must be one of elastic_f"),
    ("start = [0.1", "line = [[0, 0], [1, 0]]\nstart = [0.1", "the keys line and shape both define "
    "the curve"),
])  # fmt: skip
def test_wrong_values_of_extensions(tmp_path, old, new, words):
    assert words in message(tmp_path, old, new)


def test_register_refuses_what_seal_files_could_not_use():
    with pytest.raises(
        ValueError, match="kind of an extension must be one of friction_laws, materials"
    ):
        sm.register("laws", "mine", lambda pressure: pressure)
    with pytest.raises(ValueError, match="be a Python identifier, got 'my law'"):
        sm.register("friction_laws", "my law", lambda pressure: pressure)
    with pytest.raises(ValueError, match="must be a dataclass that derives from Measure, got int"):
        sm.register("measures", "mine", int)
    with pytest.raises(ValueError, match="'pressure_dependent' is already registered, from reg"):
        sm.register("friction_laws", "pressure_dependent", lambda pressure: pressure)
    # a module that is imported once more
    module = importlib.reload(importlib.import_module("pressure_dependent"))
    found = registry.find("friction_laws", "pressure_dependent")
    assert found is module.pressure_dependent


MEASURE = """
from dataclasses import dataclass
from seal_mdao.measures.measure import Measure

@dataclass(frozen=True)
class Odd(Measure):
    name: str = "odd"
    profile: str = ""
    order: int = 4
    share: float | None = None
    smooth: bool = True
    weights: tuple[float, ...] = (1.0, 2.0)
    sites: tuple[tuple[float, float], ...] = ()
    labels: tuple[str, ...] = ()
    scalar = False

    def __post_init__(self):
        if self.order < 1:
            raise ValueError("order must be positive")

    def size(self, result):
        return 2

@dataclass(frozen=True)
class Taken(Measure):
    name: str = "taken"
    check: float = 1.0

@dataclass(frozen=True)
class Untold(Measure):
    name: str = "untold"
    profile: str = ""
    gaps: dict = None
"""
HIGHEST = 'type = "highest_point"'


@pytest.fixture
def odd(install):
    install("rubber_laws", "rubber_any", MEASURE, "measures", "odd = rubber_any:Odd",
            "taken = rubber_any:Taken", "untold = rubber_any:Untold")  # fmt: skip


def test_a_measure_has_its_fields_as_keys(odd, tmp_path):
    """Those that are left out are as its definition says; the profile is the only one of the file."""
    given = 'type = "odd"\norder = 2\nsmooth = false\nlabels = ["a", "b"]\nsites = [[0, 1], [2, 3]]'
    file = read(tmp_path, HIGHEST, given)
    made = file.measures[0].measure(None)
    assert (made.profile, made.order, made.share, made.smooth) == ("roll", 2, None, False)
    assert (made.weights, made.sites) == ((1.0, 2.0), ((0.0, 1.0), (2.0, 3.0)))
    assert made.labels == ("a", "b")
    assert [entry.single for entry in file.measures] == [False, True]


@pytest.mark.parametrize(("line", "words"), [
    ('order = 2.5', "order = 2.5, but it must be a whole number"),
    ('smooth = 1', "smooth = 1, but it must be true or false"),
    ('weights = ["a"]', "weights = ['a'], but it must be a list of numbers"),
    ('labels = "a"', "labels = 'a', but it must be a list of names"),
    ('share = true', "share = True, but it must be a number"),
    ('profile = "rol"', "profile = 'rol', but there is no such profile (did you mean 'roll'?)"),
    ('ordr = 2', "unknown key 'ordr' (did you mean 'order'?)"),
])  # fmt: skip
def test_wrong_fields_of_a_measure(odd, tmp_path, line, words):
    found = message(tmp_path, HIGHEST, f'type = "odd"\n{line}')
    assert found.startswith("[[measure]] 1: ")
    assert words in found


def test_a_field_that_every_table_has_is_refused(odd, tmp_path):
    found = message(tmp_path, HIGHEST, 'type = "taken"')
    assert found == (
        "[[measure]] 1: the class Taken cannot be used in seal files, because the name of its "
        "field 'check' is reserved for a key of its table; rename the field"
    )
    # what no table can give, and has a default, is left to it
    assert read(tmp_path, HIGHEST, 'type = "untold"').measures[0].measure(None).gaps is None


def test_what_a_measure_itself_refuses_is_one_line(odd, tmp_path):
    path = tmp_path / "block.toml"
    path.write_text(BLOCK.replace(HIGHEST, 'type = "odd"\norder = 0'))
    with pytest.raises(sm.SealFileError) as caught:
        sm.build_seal(path)
    assert str(caught.value) == f"{path}: [[measure]] 1 ('odd'): order must be positive"


def test_a_measure_that_needs_nothing_may_be_minimised_by_its_type(odd, tmp_path):
    text = f'{HIGHEST}\nname = "peak"\n[optimize]\nminimize = "highest_point"'
    file = read(tmp_path, HIGHEST, text)
    assert [measure.name for measure in file.measures] == ["peak", "reaction", "highest_point"]
    assert "[optimize]: minimize = 'odd'" in message(tmp_path, "highest_point", "odd\"\nname = "
        '"peak"\n[optimize]\nminimize = "odd')  # fmt: skip


def test_what_was_read_may_be_changed(tmp_path):
    """Profiles with a law and a curve of their own, and terms, as ``dataclasses.replace`` makes them."""
    file = read(tmp_path)
    (profile,), (term,) = file.profiles, file.terms
    moved = replace(profile, start=(0.2, 3.05))
    assert moved.friction is profile.friction
    assert moved.shape is profile.shape
    assert replace(term, name="other").arguments == {"stiffness": 300.0}


def test_a_law_that_is_registered_anew_is_another_seal(tmp_path, monkeypatch):
    """As when the cell of a notebook is changed and run again: the text of the file is the same."""
    monkeypatch.setattr("seal_mdao.registry._registered", dict(registry._registered))
    (tmp_path / "block.toml").write_text(
        BLOCK.replace(GIVEN, 'friction = { law = "edited", friction = 0.5 }')
    )

    def built(factor):
        @sm.register("friction_laws", "edited")
        def edited(pressure, friction):
            return factor * friction * pressure

        return sm.build_seal(tmp_path / "block.toml")

    cache, first = sm.AnalysisCache(), built(1.0)
    before, placed = cache.analyze(first), first.with_placements()
    second = built(0.2)
    after = cache.analyze(second)
    assert after.value("reaction") == sm.analyze(second).value("reaction")
    assert after.value("reaction") != before.value("reaction")
    # the first seal has its law of then, with other parameters too
    assert cache.analyze(first).value("reaction") == before.value("reaction")
    assert first.with_placements().key == placed.key != second.with_placements().key
    assert cache.made == 2
