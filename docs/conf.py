"""Sphinx's configuration of the documentation site, which `scripts/docs` builds from copies of the pages."""

from __future__ import annotations

import sys
from pathlib import Path
from typing import Any

from docutils import nodes
from docutils.utils.math import latex2mathml, unichar2tex
from sphinx.domains.python import PyObject
from sphinx.util.inspect import TypeAliasForwardRef

# The staged copy of this file lies in out/docs/source.
sys.path.insert(
    0, str(next(p / "scripts" for p in Path(__file__).resolve().parents if (p / "pyproject.toml").exists()))
)

import ulna

project = "Ulna"
author = "the authors of Ulna"
release = version = ulna.__version__
html_title = f"Ulna {release}"
extensions = [
    "myst_parser",
    "sphinx.ext.autodoc",
    "sphinx.ext.napoleon",
    "sphinx_design",
    "sphinx_copybutton",
]
root_doc = "index"
smartquotes = False
suppress_warnings = ["myst.xref_missing", "myst.header"]  # `built.py` checks every link of the result

myst_enable_extensions = ["colon_fence", "deflist", "dollarmath", "attrs_inline"]
myst_heading_anchors = 4
myst_dmath_double_inline = True

autodoc_member_order = "bysource"
autodoc_typehints = "signature"
autodoc_class_signature = "mixed"
autodoc_preserve_defaults = True
autodoc_inherit_docstrings = True
# Arrays are named as in the sources: what NumPy's ArrayLike stands for takes four lines.
autodoc_type_aliases = {name: name for name in ("Array", "ArrayLike", "Floats", "Integers", "Numbers")}
napoleon_google_docstring = True
napoleon_numpy_docstring = False
napoleon_use_rtype = False
napoleon_use_ivar = True
python_use_unqualified_type_names = True
add_module_names = False
toc_object_entries = False

html_theme = "furo"
html_static_path = ["_static"]
html_css_files = ["site.css"]
html_js_files = ["live.js"]
html_extra_path = ["_extra"]
html_show_sourcelink = False
html_show_copyright = False
html_copy_source = False
html_favicon = "_static/logo.svg"
html_logo = "_static/logo.svg"
html_math_renderer = "mathml"
html_theme_options = {"navigation_with_keys": True, "top_of_page_buttons": []}
copybutton_exclude = ".linenos, .gp, .go"
copybutton_selector = "div:not(.output) > div.highlight > pre"
pygments_style = "a11y-light"  # a contrast of 4.5 or more, comments too; comes with Furo
pygments_dark_style = "github-dark"


def _formula(self: Any, node: nodes.Node, as_block: bool) -> None:
    """A formula as MathML, which browsers draw by themselves: no script, no font from elsewhere."""
    markup = latex2mathml.tex2mathml(node.astext().translate(unichar2tex.uni2tex_table), as_block=as_block)
    self.body.append(f'<div class="formula">{markup}</div>' if as_block else markup)
    raise nodes.SkipNode


def setup(app: Any) -> dict[str, bool]:
    """Sphinx's entry: the renderer of formulas, and docstrings as reStructuredText."""
    from docs_site import docstrings

    app.add_html_math_renderer(
        "mathml",
        inline_renderers=(lambda self, node: _formula(self, node, as_block=False), None),
        block_renderers=(lambda self, node: _formula(self, node, as_block=True), None),
    )
    next(f for f in PyObject.doc_field_types if f.name == "variable").label = "Attributes"
    TypeAliasForwardRef.__repr__ = lambda self: self.name  # as within Mapping[str, Floats]
    app.connect("autodoc-process-signature", docstrings.name_arrays)
    app.connect("autodoc-skip-member", docstrings.skip_former_names)
    app.connect("autodoc-process-docstring", docstrings.process, priority=100)
    app.connect("autodoc-process-docstring", docstrings.keep_attributes, priority=900)
    return {"parallel_read_safe": True, "parallel_write_safe": True}
