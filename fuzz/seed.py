"""Begins the corpora with the scenarios of this repository: its `.hri` files, and the ```hri blocks of its pages."""

import hashlib
import pathlib
import re

ROOT = pathlib.Path(__file__).resolve().parent.parent
SKIP = {"target", "fuzz", "node_modules", ".git"}
BLOCK = re.compile(r"^```hri[^\n]*\n(.*?)^```", re.M | re.S)


def texts():
    for path in sorted(ROOT.rglob("*.hri")):
        if SKIP.isdisjoint(path.relative_to(ROOT).parts):
            text = path.read_text(encoding="utf-8")
            tests = path.with_name(path.stem + ".tests.hri")
            if tests.exists():
                yield text + "\n//====\n\n//====\n" + tests.read_text(encoding="utf-8")
            yield text
    for path in sorted(ROOT.rglob("*.md")):
        if SKIP.isdisjoint(path.relative_to(ROOT).parts):
            yield from BLOCK.findall(path.read_text(encoding="utf-8"))


for target in ("lexer", "parser", "checker", "formatter"):
    folder = ROOT / "fuzz" / "work" / target
    folder.mkdir(parents=True, exist_ok=True)
    for text in texts():
        data = text.encode()
        (folder / hashlib.sha1(data).hexdigest()).write_bytes(data)
