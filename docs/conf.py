# SPDX-License-Identifier: Apache-2.0
# The site of the documentation: `make docs` builds it from Markdown with Debian's Sphinx, MyST and
# Furo, without a network. The source folder is the root of the repository, so that pages may link to
# ARCHITECTURE.md and to sources.
import re
from pathlib import Path

root = Path(__file__).resolve().parent.parent

project = "Lucerna"
author = "the Lucerna authors"
copyright = "the Lucerna authors, Apache-2.0"
version = release = re.search(r"^project\(\s*[Ll]ucerna\s+VERSION\s+([\d.]+)",
                              (root / "CMakeLists.txt").read_text(), re.M).group(1)

extensions = ["myst_parser"]
source_suffix = {".md": "markdown"}
root_doc = "docs/index"
include_patterns = ["docs/**", "examples/*.md", "benchmarks/*.md", "ARCHITECTURE.md", "CONTRIBUTING.md", "CHANGELOG.md"]
exclude_patterns = ["build*", "demo", "third_party", "tests", "src", "fuzz", "bench", ".*", "README.md"]

myst_heading_anchors = 4
suppress_warnings = ["myst.header"]  # a page may begin its parts at any level
nitpicky = True

html_theme = "furo"
html_title = f"Lucerna {release}"
html_static_path = ["_static"]
html_css_files = ["site.css"]
html_extra_path = ["_extra"]
html_show_sphinx = False
html_copy_source = False
pygments_style = "friendly"
