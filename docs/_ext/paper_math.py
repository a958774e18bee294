"""Equations as MathML, with the numbers of the paper.

MathML needs neither a network nor a script in the browser. A displayed equation that carries the
label ``eq-17`` is number (17) of the paper, whatever its place in these pages, and ``{eq}`eq-17```
refers to it as (17). Labels of other forms (``eq-vci``) print what follows ``eq-``.
"""

import re
from html import unescape
from xml.etree import ElementTree

from docutils import nodes
from docutils.utils.math import MathError
from docutils.utils.math.latex2mathml import tex2mathml
from sphinx.util import logging
from sphinx.writers.html5 import HTML5Translator

PREFIX = "eq-"
ACCENTS = set("ˉ˙~^→¨")
BOLD_GREEK = {r"\boldsymbol\lambda": "𝝀", r"\boldsymbol\Lambda": "𝚲", r"\boldsymbol\sigma": "𝝈"}
NAMED_ENTITY = re.compile(r"&(?!amp;|lt;|gt;|quot;|apos;|#)\w+;")
logger = logging.getLogger(__name__)


def paper_number(label: str) -> str:
    """What stands in the brackets beside the equation with this label."""
    return label.removeprefix(PREFIX)


def prepared(tex: str) -> str:
    """Bold Greek as letters; primes as superscripts, joined with a superscript that follows."""
    for command, letter in BOLD_GREEK.items():
        tex = tex.replace(command, letter)
    joined = re.sub(r"'\^(\w)", r"'^{\1}", tex)
    return re.sub(r"'\^\{", r"^{\\prime", joined).replace("'", r"^{\prime}")


def script_beside_accent(element) -> None:
    """Put the subscript of an accented letter beside it; docutils puts it below."""
    base, below, above = list(element)
    if above.tag == "mo" and (above.text or "").strip() in ACCENTS:
        element[:] = []
        element.tag = "msub"
        ElementTree.SubElement(element, "mover", accent="true").extend([base, above])
        element.append(below)


def keep_bars_short(root) -> None:
    """Bars of \\lvert ... \\rvert as high as the letters; docutils lets them stretch."""
    opened = 0
    for bar in root.iter("mo"):
        if (bar.text or "").strip() not in ("|", "‖"):
            continue
        if bar.get("class") == "mathopen":
            opened += 1
            bar.attrib.update(stretchy="false", form="prefix")
        elif opened:
            opened -= 1
            bar.attrib.update(stretchy="false", form="postfix")


def improved(source: str) -> str:
    """The converter's MathML with two flaws mended."""
    plain = source.replace(' xmlns="http://www.w3.org/1998/Math/MathML"', "")
    root = ElementTree.fromstring(NAMED_ENTITY.sub(lambda m: unescape(m[0]), plain))
    for element in list(root.iter("munderover")):
        script_beside_accent(element)
    keep_bars_short(root)
    return ElementTree.tostring(root, encoding="unicode", short_empty_elements=False)


def mathml(node, as_block: bool) -> str:
    """MathML of a node; a warning, and the source, where it cannot be converted."""
    try:
        return improved(tex2mathml(prepared(node.astext()), as_block=as_block))
    except MathError as error:
        logger.warning("%s in %r", error, node.astext(), location=node, type="math")
        return f"<code>{nodes.unescape(node.astext())}</code>"


def visit_inline(translator: HTML5Translator, node: nodes.math) -> None:
    translator.body.append(mathml(node, False))
    raise nodes.SkipNode


def visit_block(translator: HTML5Translator, node: nodes.math_block) -> None:
    label, anchor, number = node.get("label"), "", ""
    if label is not None:
        anchor = f' id="equation-{label}"'
        number = f'<span class="equation-number">({paper_number(label)})</span>'
    translator.body.append(f'<div class="equation"{anchor}>{mathml(node, True)}{number}</div>\n')
    raise nodes.SkipNode


def use_paper_numbers(app, doctree) -> None:
    """Replace Sphinx's running numbers of labelled equations by the paper's."""
    objects = app.env.get_domain("math").data["objects"]
    for node in doctree.findall(nodes.math_block):
        label = node.get("label")
        if label in objects:
            objects[label] = (objects[label][0], paper_number(label))
            node["number"] = paper_number(label)


def setup(app):
    app.add_html_math_renderer("paper", (visit_inline, None), (visit_block, None))
    app.connect("doctree-read", use_paper_numbers)
    return {"parallel_read_safe": True, "parallel_write_safe": True}
