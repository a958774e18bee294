"""Values that are no good are refused by name, in one line, before anything is computed."""

import re
from dataclasses import fields
from fractions import Fraction
from inspect import cleandoc

import numpy as np
import openmdao.api as om
import pytest

import seal_mdao as sm
from seal_mdao.measures.reaction import Reaction
from seal_mdao.seals.door.door_options import DoorOptions
from seal_mdao.seals.settings import seal_of

SEAL = [
    ("friction", 10**400), ("friction", 11.0), ("friction", np.array([0.1, 0.2])), ("friction", 0.1j),
    ("friction", True), ("basis_order", np.array([1, 2])), ("basis_order", True),
    ("symmetric", "no"), ("symmetric", [1, 2]), ("symmetric", 1), ("door", np.array("corner")),
    ("layers", 2), ("layers", 41), ("n_gauss", 1), ("n_gauss", 100), ("n_gauss", 1000),
    ("n_gauss", (2,)), ("n_gauss", (2, 3, 2)), ("n_gauss", (1, 3)), ("n_gauss", (2, 2.5)),
    ("n_gauss", "23"),
    ("rays", 58 * 41), ("segments", 10**8), ("outer_parameters", 10**7), ("inner_parameters", 10**7),
    ("corner_x", 1e300), ("corner_x", 51.0), ("normal_penalty", 1e-300), ("normal_penalty", 10.0),
    ("normal_penalty", 1e30), ("tangent_penalty", 1e-300), ("depth", 1e-12), ("depth", 1e-9),
    ("start", 1e300), ("nominal_door_radius", 1e-300), ("door_radius", "wide"),
    ("door_radius", 10**400), ("support", 1e300), ("n_steps", True), ("n_steps", 10**400),
]  # fmt: skip


@pytest.mark.parametrize(("name", "value"), SEAL)
def test_wrong_option_of_the_seal_is_named(name, value):
    with pytest.raises(ValueError, match=name) as error:
        sm.door_seal(**{name: value})
    assert len(str(error.value)) < 300
    assert "\n" not in str(error.value)


@pytest.mark.parametrize(
    ("name", "value"),
    [("inner_radius", "7.5"), ("inner_radius", None), ("outer_radius", 10**400),
     ("outer_radius", 1e300), ("base_angle", "wide"), ("base_angle", [0.1]), ("inner_radius", np.nan)],
)  # fmt: skip
def test_wrong_type_in_a_section_is_named(name, value):
    with pytest.raises(ValueError, match=name):
        sm.Section(**{name: value})


@pytest.mark.parametrize(
    ("law", "wrong"),
    [(sm.MooneyRivlin, {"c10": "soft"}), (sm.MooneyRivlin, {"c10": None}),
     (sm.MooneyRivlin, {"c01": [1.0]}), (sm.MooneyRivlin, {"bulk_modulus": 1e30}),
     (sm.MooneyRivlin, {"bulk_modulus": 10**400}), (sm.NeoHookean, {"c10": "soft"}),
     (sm.Gent, {"limit": "far"})],
)  # fmt: skip
def test_wrong_constant_of_a_material_is_named(law, wrong):
    with pytest.raises(ValueError, match=next(iter(wrong))):
        law(**wrong)


@pytest.mark.parametrize("mu", ["soft", [[1.0], [1.0, 2.0]], 1j])
def test_wrong_terms_of_a_material_are_named(mu):
    with pytest.raises(ValueError, match="mu of Ogden"):
        sm.Ogden(mu=mu, alpha=(2.0,))


@pytest.mark.parametrize(
    "wrong",
    [{"tolerance": 1e9}, {"tolerance": "tight"}, {"tolerance": None}, {"tolerance": 1e-3},
     {"max_iterations": True}, {"max_iterations": 10**400}, {"max_cuts": 1000},
     {"damped_iterations": "many"}],
)  # fmt: skip
def test_wrong_newton_option_is_named(wrong):
    with pytest.raises(ValueError, match=next(iter(wrong))):
        sm.NewtonOptions(**wrong)


@pytest.mark.parametrize(
    "offsets",
    ["drawn", ["a"] * 25, [[0.0], [0.0, 1.0]], np.zeros(25, complex), {"a": 1}, [None] * 25],
)
def test_wrong_offsets_are_named(offsets):
    with pytest.raises(ValueError, match="boundary_offsets"):
        sm.analyze(sm.door_seal(), offsets)


@pytest.mark.parametrize("radius", ["wide", [[4.0], [4.0, 5.0]], 4.0 + 1j, None, 1e-300])
def test_wrong_radius_is_named(radius):
    with pytest.raises(ValueError, match="door_radius"):
        sm.analyze(sm.door_seal(), parameters={"door_radius": radius})


def test_fractions_and_numpy_numbers_are_numbers():
    seal = sm.door_seal(friction=Fraction(1, 4), symmetric=np.bool_(False), depth=np.float32(10.0))
    assert seal.key == sm.door_seal().key == seal_of(seal.settings()).key
    assert seal.check_offsets([Fraction(0)] * 25).tolist() == [0.0] * 25


def _class(name):
    """The class of the options of a constructor."""
    return DoorOptions if name == "DoorOptions" else getattr(sm, name)


OF_TERMS = {"mu": (100.0,), "alpha": (2.0,)}
CONSTRUCTORS = {
    "DoorOptions": (sm.door_seal, {}), "Section": (sm.Section, {}),
    "NewtonOptions": (sm.NewtonOptions, {}),
    "MooneyRivlin": (sm.MooneyRivlin, {}), "NeoHookean": (sm.NeoHookean, {}), "Yeoh": (sm.Yeoh, {}),
    "Gent": (sm.Gent, {}), "Ogden": (sm.Ogden, OF_TERMS),
    "Hyperfoam": (sm.Hyperfoam, OF_TERMS | {"nu": (0.3,)}),
}  # fmt: skip
KEYWORDS = [(name, field.name) for name in CONSTRUCTORS for field in fields(_class(name))]
FREE_TO_BE_NONE = {"door_radius", "segments", "step_ends"}


@pytest.mark.parametrize(("kind", "keyword"), KEYWORDS, ids=map("-".join, KEYWORDS))
def test_every_keyword_has_bounds(kind, keyword):
    """Those to come as well: what is no value is refused by name, in one line of some length."""
    make, others = CONSTRUCTORS[kind]
    wrong = [
        np.nan,
        np.inf,
        -np.inf,
        1e300,
        -1e300,
        10**400,
        "text",
        [1, [2, 3]],
        {},
        1j,
        b"no",
        object(),
    ]
    for value in wrong if keyword in FREE_TO_BE_NONE else [*wrong, None]:
        with pytest.raises((ValueError, TypeError), match=re.escape(keyword)) as error:
            make(**(others | {keyword: value}))
        assert len(str(error.value)) < 300, value
        assert "\n" not in str(error.value)


STATED = [
    (name, field) for name, field in KEYWORDS if name in ("DoorOptions", "Section", "NewtonOptions")
]


@pytest.mark.parametrize(("kind", "keyword"), STATED, ids=map("-".join, STATED))
def test_every_keyword_is_described(kind, keyword):
    described = re.findall(r"^([a-z_0-9, ]+) : ", cleandoc(_class(kind).__doc__), re.MULTILINE)
    assert keyword in ", ".join(described).split(", ")


@pytest.mark.parametrize("memory", [-1.0, np.nan, 1e300, "much", None, [1, 2]])
def test_wrong_memory_is_named(memory):
    """A list used to be repeated 2**30 times."""
    with pytest.raises(ValueError, match="memory"):
        sm.AnalysisCache(memory)
    with pytest.raises(ValueError, match="factor_memory"):
        sm.SealGroup(seal=sm.door_seal(), factor_memory=memory)


SHORT = {"depth": 0.5, "n_steps": 5}


@pytest.mark.parametrize(
    ("arguments", "keywords", "word"),
    [(("drawn",), {}, "seal"), ((None,), {}, "seal"), ((sm.Section(),), {}, "seal"),
     ((sm.door_seal(**SHORT), None, [4.0]), {}, "parameters"),
     ((sm.door_seal(**SHORT), None, "friction"), {}, "parameters"),
     ((sm.door_seal(**SHORT), None, {"fiction": 0.1}), {}, "fiction"),
     ((sm.door_seal(**SHORT), None, {1: 0.1}), {}, "1"),
     ((sm.door_seal(**SHORT),), {"keep_factors": "no"}, "keep_factors"),
     ((sm.door_seal(**SHORT),), {"callback": 3}, "callback")],
)  # fmt: skip
def test_wrong_argument_of_an_analysis_is_named(arguments, keywords, word):
    with pytest.raises((ValueError, TypeError), match=word):
        sm.analyze(*arguments, **keywords)


@pytest.mark.parametrize("call", [sm.estimate, sm.analyze, sm.differentiate])
def test_what_is_no_seal_or_result_is_refused(call):
    with pytest.raises(TypeError, match="must be"):
        call("drawn")


@pytest.mark.parametrize(
    ("options", "word"),
    [({"parameters": "friction"}, "parameters"), ({"parameters": ("fiction",)}, "fiction"),
     ({"measures": ("gaps",)}, "gaps"), ({"measures": (3,)}, "measure"), ({"method": None}, "method")],
)  # fmt: skip
def test_wrong_argument_of_sensitivities_is_named(options, word):
    result = sm.analyze(sm.door_seal(**SHORT))
    with pytest.raises((ValueError, TypeError), match=word):
        sm.differentiate(result, **options)


@pytest.mark.parametrize("tolerance", [-1.0, 0.0, np.nan, 2.0, "small", None])
def test_wrong_step_tolerance_is_named_at_once(tolerance):
    """It used to take all rounds of halving."""
    with pytest.raises(ValueError, match="step_tolerance"):
        sm.door_seal(steps="auto", step_tolerance=tolerance)


@pytest.mark.parametrize(
    "options", [{"accuracy": ["paper"]}, {"accuracy": None}, {"steps": 3}, {"steps": ["auto"]}]
)
def test_wrong_choice_of_the_discretisation_is_named(options):
    with pytest.raises(ValueError, match=next(iter(options))):
        sm.door_seal(**options)


@pytest.mark.parametrize(
    "travels", [(10**400,), "far", (np.nan,), (-1.0,), 1j, ((1.0,), (1.0, 2.0))]
)
def test_wrong_travels_are_named(travels):
    with pytest.raises(ValueError, match="travels"):
        Reaction("door", travels)


def test_one_travel_is_a_list_of_one():
    assert Reaction("door", 2.0) == Reaction("door", [2.0]) == Reaction("door", (2.0,))


@pytest.mark.parametrize("value", [np.nan, -1, 1e300, 10**400, "many", None, 1j, [1]])
@pytest.mark.parametrize(
    "option", ["tol", "feas_tol", "maxiter", "max_failures", "singular_jac_tol", "trust_radius"]
)
def test_wrong_option_of_a_driver_is_named(option, value):
    with pytest.raises(ValueError, match=option):
        sm.UnoDriver(**{option: value})


@pytest.mark.parametrize("option", [{"tol": np.nan}, {"maxiter": 10**12}])
def test_wrong_option_of_slsqp_is_named_before_the_model_runs(option):
    problem = om.Problem(driver=sm.SlsqpDriver(**option), reports=None)
    problem.model.add_subsystem("c", om.ExecComp("f = x**2", x=3.0), promotes=["*"])
    problem.model.add_design_var("x")
    problem.model.add_objective("f")
    problem.setup()
    with pytest.raises(ValueError, match=next(iter(option))):
        problem.run_driver()
    assert problem.get_val("x")[0] == 3.0


@pytest.mark.parametrize("path", ["", ".", 3, None])
def test_recorder_without_a_file_name_is_refused(path):
    with pytest.raises(ValueError, match="filepath"):
        sm.RestartRecorder(path)


@pytest.mark.parametrize("changes", [{"alpha": (500.0,)}, {"alpha": (1e-9,)}, {"mu": (1e20,)}])
@pytest.mark.parametrize("law", ["Ogden", "Hyperfoam"])
def test_powers_without_numbers_are_refused(law, changes):
    make, others = CONSTRUCTORS[law]
    with pytest.raises(ValueError, match=next(iter(changes))):
        make(**(others | changes))


@pytest.mark.parametrize(
    ("name", "arguments", "said"),
    [
        ("build_seal", [3], "file must be a SealFile, got 3"),
        ("write_dxf", ["seal.toml", "x.dxf"], "outline must be an Outline, got 'seal.toml'"),
        ("restart", ["cases.sql", "cases.sql"], "problem must be a Problem, got 'cases.sql'"),
    ],
)
def test_paths_in_place_of_what_was_read_from_them(name, arguments, said):
    with pytest.raises(TypeError) as error:
        getattr(sm, name)(*arguments)
    assert str(error.value) == said
