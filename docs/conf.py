"""Sphinx configuration.

A build first makes what the pages take from the code: the equation table, the component, driver and
option tables, one page per folder of the package, and the figures whose sources have changed. It
executes the notebooks, which are stored without outputs. With the tag ``nofigures`` (``sphinx-build
-t nofigures``) it makes no figures and executes no notebook: figures that are not there are grey,
their numbers are an ellipsis.
"""

import json
import os
import subprocess
import sys
from pathlib import Path

import numba

# numba's dispatchers hide signatures and docstrings; here nothing is computed in this process. Not by
# the environment variable, which the scripts and the kernels of notebooks would inherit
numba.config.DISABLE_JIT = True

HERE = Path(__file__).resolve().parent
GENERATED = HERE / "_generated"
# the last one for the package ``verification``: the benchmarks that the tests assert
sys.path[:0] = [str(HERE / "_ext"), str(HERE), str(HERE.parent / "tests")]

import api_pages  # noqa: E402
import equation_index  # noqa: E402
import placeholders  # noqa: E402
import seal_file_tables  # noqa: E402
from figures import limits  # noqa: E402

import seal_mdao  # noqa: E402
from seal_mdao import user_cache  # noqa: E402
from seal_mdao.seals.file import json_schema  # noqa: E402

# scripts and notebooks show the choice of load steps and penalties, which commands would store
os.environ[user_cache.FOLDER] = ""

# ---- what is made before the pages are read ----


def run_script(*arguments: str) -> None:
    """Run a Python script with the compiled package, in a process of its own."""
    subprocess.run([sys.executable, *arguments], check=True)


fragments = GENERATED / "fragments"
run_script(str(HERE / "_ext" / "code_reference.py"), str(fragments))
index = equation_index.table(equation_index.read())
(fragments / "equation_index.md").write_text(index, encoding="utf-8")
seal_file_tables.write_all(fragments)
json_schema.main([str(GENERATED / "seal_file.schema.json")])
api_pages.write_all(GENERATED / "api")
if "nofigures" in tags:  # noqa: F821, defined by Sphinx
    placeholders.write_missing(HERE, GENERATED)
else:
    jobs = str(min(2, os.cpu_count() or 1))
    run_script(str(HERE / "make_figures.py"), "--changed", "--jobs", jobs)

# ---- the project ----

project = "seal_mdao"
author = "The seal_mdao developers"
copyright = author
version = release = seal_mdao.__version__

extensions = [
    "myst_nb",
    "sphinx.ext.autodoc",
    "sphinx.ext.napoleon",
    "docstrings",
    "paper_math",
]
# paper.md is the article for the Journal of Open Source Software, in its own format
exclude_patterns = [
    "_build",
    "benchmarks",
    "_generated/fragments",
    "paper.md",
    "Thumbs.db",
    ".DS_Store",
]
# napoleon refers to attributes by their bare names, of which there are several
suppress_warnings = ["ref.python"]

myst_enable_extensions = [
    "dollarmath",
    "amsmath",
    "substitution",
    "colon_fence",
    "attrs_block",
    "attrs_inline",
]
myst_heading_anchors = 3
myst_substitutions = {
    path.stem: json.loads(path.read_text(encoding="utf-8"))
    for path in sorted((GENERATED / "numbers").glob("*.json"))
}
if "nofigures" in tags:  # noqa: F821
    myst_substitutions = placeholders.numbers(HERE, myst_substitutions)
myst_substitutions["tolerances"] = limits.texts()

# a notebook is executed whenever Sphinx reads it, for none is stored with outputs
nb_execution_mode = "off" if "nofigures" in tags else "auto"  # noqa: F821
nb_execution_in_temp = True
nb_execution_raise_on_error = True
nb_execution_timeout = 120

napoleon_google_docstring = False
napoleon_use_ivar = True
napoleon_use_rtype = False
autodoc_member_order = "bysource"
autodoc_typehints = "none"
autodoc_use_type_comments = False  # there are none, and looking for them takes time
add_module_names = False
toc_object_entries = False

# ---- HTML ----

html_theme = "furo"
html_title = f"seal_mdao {version}"
html_math_renderer = "paper"
html_static_path = ["_static"]
html_css_files = ["pages.css"]
html_copy_source = False
html_show_sphinx = False
html_theme_options = {
    "light_css_variables": {"color-brand-primary": "#0072B2", "color-brand-content": "#0072B2"},
    "dark_css_variables": {"color-brand-primary": "#56B4E9", "color-brand-content": "#56B4E9"},
}
