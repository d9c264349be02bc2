"""What happens while mkdocs builds the site; each hook hands on to one file of ``manual``."""

from __future__ import annotations

import json
import re
from pathlib import Path
from typing import Any

from mkdocs.config.defaults import MkDocsConfig
from mkdocs.structure.files import File, Files
from mkdocs.structure.pages import Page
from pymdownx.slugs import slugify

from manual import links, made, marks, mathematics, navigation
from manual.places import PROJECT, ROOT

_PATH = re.compile(r"(?<=<td><code>)[\w\[\]]+(?:\.[\w\[\]]+)+(?=</code>)")
_HEADING = re.compile(r"^# (.+)$|^## (\S.*)$", re.MULTILINE)


def on_config(config: MkDocsConfig) -> None:
    """Make the anchors of headings as they are made where Markdown is read on disk."""
    config.mdx_configs.setdefault("toc", {})["slugify"] = slugify(case="lower")


def on_files(files: Files, *, config: MkDocsConfig) -> Files:
    """Add the pages beside docs/ and what they link to; derive the navigation."""
    for name, place in PROJECT.items():
        files.append(File.generated(config, place, abs_src_path=str(ROOT / name)))
    for place, item in {**links.files_to_copy(), **made.files()}.items():
        if isinstance(item, Path):
            files.append(File.generated(config, place, abs_src_path=str(item)))
        else:
            files.append(File.generated(config, place, content=item))
    config.nav = navigation.navigation({file.src_uri: _heading(file) for file in files.documentation_pages()})
    return files


def on_page_markdown(markdown: str, *, page: Page, config: MkDocsConfig, files: Files) -> str:
    """Fill in what is made, show the names of files above their blocks, turn links out of docs/ to the copies."""
    source = page.file.abs_src_path
    text = links.for_the_site(markdown, Path(source)) if source else markdown
    return made.filled(marks.with_titles(text))


def on_page_content(html: str, *, page: Page, config: MkDocsConfig, files: Files) -> str:
    """Set formulas, let wide tables scroll by themselves and long paths of fields break at their points."""
    text = mathematics.with_mathml(html, page.file.src_uri)
    text = _PATH.sub(lambda item: item[0].replace(".", ".<wbr>"), text)
    return re.sub(r"<table.*?</table>", r'<div class="scroll" tabindex="0">\g<0></div>', text, flags=re.DOTALL)


def on_post_build(*, config: MkDocsConfig) -> None:
    """Turn the index of the search into a script: a page opened from disk may load no JSON."""
    folder = Path(config.site_dir)
    index = json.loads((folder / "search" / "search_index.json").read_text(encoding="utf-8"))
    documents: list[dict[str, Any]] = index["docs"]
    text = json.dumps([[item["location"], item["title"], item["text"]] for item in documents], ensure_ascii=False)
    (folder / "search" / "index.js").write_text(f"window.pagesOfTheManual = {text};\n", encoding="utf-8")
    (folder / "search" / "search_index.json").unlink()
    for name in ("sitemap.xml", "sitemap.xml.gz"):
        (folder / name).unlink(missing_ok=True)


def _heading(file: File) -> str:
    """Return the first heading of a page without its marks."""
    found = _HEADING.search(file.content_string)
    return (found[1] or found[2]).replace("`", "").strip() if found else file.name
