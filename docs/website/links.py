"""Check a built site without a network: every link inside it leads to a file and an anchor of it.

Nothing may be loaded from elsewhere either: no script, style, font or picture.
"""

from __future__ import annotations

import sys
from html.parser import HTMLParser
from pathlib import Path
from urllib.parse import unquote, urlsplit

LOADED = {"script": "src", "img": "src", "link": "href", "iframe": "src", "source": "src"}


class Page(HTMLParser):
    """What a page links to, what it loads, and its anchors."""

    def __init__(self, text: str) -> None:
        super().__init__()
        self.links: list[str] = []
        self.loads: list[str] = []
        self.anchors: set[str] = {"", "top"}
        self.feed(text)

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        """Collect from one tag."""
        given = {name: value for name, value in attrs if value is not None}
        self.anchors.update(given[key] for key in ("id", "name") if key in given)
        if tag == "a" and "href" in given:
            self.links.append(given["href"])
        if tag in LOADED and LOADED[tag] in given and given.get("rel") != "canonical":
            self.loads.append(given[LOADED[tag]])


def faults(site: Path) -> list[str]:
    """What is wrong with the links of a site, one line each."""
    pages = {file.resolve(): Page(file.read_text("utf-8")) for file in sorted(site.rglob("*.html"))}
    found = [] if pages else [f"{site}: no pages"]
    for file, page in pages.items():
        name = file.relative_to(site.resolve())
        for link in page.loads:
            if urlsplit(link).netloc:
                found.append(f"{name}: loads {link} from elsewhere")
        for link in {*page.links, *page.loads}:
            if lost(file, link, pages):
                found.append(f"{name}: {link} leads nowhere")
    return sorted(found)


def lost(file: Path, link: str, pages: dict[Path, Page]) -> bool:
    """Whether a link inside the site leads nowhere."""
    parts = urlsplit(link)
    if parts.scheme or parts.netloc:
        return False
    there = (file.parent / unquote(parts.path)).resolve() if parts.path else file
    if there in pages:
        return unquote(parts.fragment) not in pages[there].anchors
    return not there.is_file()


def main() -> None:
    """Check the site of the first argument; 1 and a line for each fault."""
    found = faults(Path(sys.argv[1]))
    print("\n".join(found), file=sys.stderr, end="\n" if found else "")
    sys.exit(1 if found else 0)


if __name__ == "__main__":
    main()
