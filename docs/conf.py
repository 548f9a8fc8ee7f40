"""The site of docs/: `python -m sphinx -W --keep-going docs build/docs`, with the extra `docs`."""

import os
import sys
from pathlib import Path

DOCS = Path(__file__).parent
ROOT = DOCS.parent
sys.path[:0] = [str(ROOT), str(DOCS)]
# Kernels import this checkout.
os.environ["PYTHONPATH"] = os.pathsep.join(filter(None, [str(ROOT), os.environ.get("PYTHONPATH")]))

import symofros  # noqa: E402  the package of this checkout

project = "SYMOFROS"
author = "the authors of SYMOFROS"
version = release = symofros.__version__
extensions = [
    "myst_nb",
    "sphinx.ext.autodoc",
    "sphinx.ext.napoleon",
    "site_extensions.commands",
    "site_extensions.docstrings",
    "site_extensions.equations",
    "site_extensions.figures",
    "site_extensions.links",
]
exclude_patterns = ["ci", "site_extensions"]

# Pages are read on GitHub as well: plain Markdown, anchors as GitHub makes them. Equations are text, as in the code.
myst_heading_anchors = 4
myst_enable_extensions = ["deflist"]
highlight_language = "none"

# Steps of the tutorial are executed by the build, once; what they print is kept by their content.
nb_execution_mode = "cache"
nb_execution_cache_path = str(ROOT / "build" / "notebooks")
nb_execution_raise_on_error = True
nb_execution_timeout = 120
nb_execution_in_temp = True
nb_merge_streams = True

# Docstrings: Google's style; `name` is code, as in Markdown. Dataclasses list their attributes themselves.
default_role = "code"
napoleon_numpy_docstring = False
napoleon_use_ivar = True
autodoc_member_order = "bysource"
autodoc_typehints = "description"
autodoc_typehints_description_target = "documented"
autodoc_typehints_format = "short"
autodoc_preserve_defaults = True
autodoc_default_options = {"members": True}
python_use_unqualified_type_names = True
# Links between documents must lead somewhere; types are named as the code has them, with or without a page.
nitpicky = True
nitpick_ignore_regex = [("py:.*", ".*")]

html_theme = "furo"
html_title = "SYMOFROS"
html_static_path = ["static"]
html_css_files = ["site.css"]
html_copy_source = False
html_show_sphinx = False
html_show_copyright = False
