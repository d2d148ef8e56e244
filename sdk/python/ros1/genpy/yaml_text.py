"""Strings as YAML 1.1 writes them into 80 columns: between quotes, and in a list without them where nothing else would be read."""

from __future__ import annotations

import re

TYPE_CHECKING = False
if TYPE_CHECKING:
    from typing import Any

_WIDTH = 80
_BREAKS = "\n\x85\u2028\u2029"
_BLANKS = "\0 \t\r" + _BREAKS
_ESCAPES = {
    "\0": "0", "\a": "a", "\b": "b", "\t": "t", "\n": "n", "\v": "v", "\f": "f", "\r": "r", "\x1b": "e", '"': '"', "\\": "\\",
    "\x85": "N", "\xa0": "_", "\u2028": "L", "\u2029": "P",
}  # fmt: skip

#: What means something else than a string.
_OTHER = re.compile(
    r"""(?: [yY]es|YES|[nN]o|NO|[tT]rue|TRUE|[fF]alse|FALSE|[oO]n|ON|[oO]ff|OFF
    | ~|[nN]ull|NULL| | << | =
    | [-+]?0b[01_]+ | [-+]?0[0-7_]+ | [-+]?(?:0|[1-9][0-9_]*) | [-+]?0x[0-9a-fA-F_]+ | [-+]?[1-9][0-9_]*(?::[0-5]?[0-9])+
    | [-+]?[0-9][0-9_]*\.[0-9_]*(?:[eE][-+][0-9]+)? | \.[0-9][0-9_]*(?:[eE][-+][0-9]+)?
    | [-+]?[0-9][0-9_]*(?::[0-5]?[0-9])+\.[0-9_]* | [-+]?\.(?:inf|Inf|INF) | \.(?:nan|NaN|NAN)
    | \d{4}-\d\d-\d\d | \d{4}-\d\d?-\d\d?(?:[Tt]|[\ \t]+)\d\d?:\d\d:\d\d(?:\.\d*)?(?:[\ \t]*(?:Z|[-+]\d\d?(?::\d\d)?))? )""",
    re.VERBOSE,
)


def quoted(text: str) -> str:
    """Between double quotes."""
    if text.isprintable() and text.isascii():
        found = '"%s"' % text.replace("\\", "\\\\").replace('"', '\\"')
        if len(found) <= _WIDTH:
            return found
    return _Writer(0).quoted(text)


def items(values: Any) -> list[str]:
    """The lines of a list whose elements are strings, or other scalars."""
    return "\n".join("- " + _item(value) for value in values).split("\n")


def _item(value: Any) -> str:
    if isinstance(value, str):
        return _Writer(2).plain(value) if _can_be_plain(value) else _Writer(2).between(value)
    if value is None or isinstance(value, bool):
        return {None: "null", True: "true", False: "false"}[value]
    return str(value)


def _can_be_plain(text: str) -> bool:
    """Whether it is read as the same string without quotes."""
    if _OTHER.fullmatch(text) or text.startswith(("---", "...")) or text[0] == " " or text[-1] == " ":
        return False
    if text[0] in "#,[]{}&*!|>'\"%@`" or any(not " " <= letter <= "~" for letter in text):
        return False
    is_alone = len(text) == 1 or text[1] in _BLANKS
    return not (text[0] in "?:-" and is_alone or re.search(r":(?:$| )| #", text))


def _can_be_single(text: str) -> bool:
    """Whether single quotes are enough: there are only printable letters of ASCII, and no blanks at a line's ends."""
    return all(letter == "\n" or " " <= letter <= "~" for letter in text) and " \n" not in text and "\n " not in text


class _Writer:
    """Writes one scalar that begins in this column."""

    def __init__(self, column: int) -> None:
        self._column, self._parts = column, [""]

    def _write(self, text: str) -> None:
        self._parts.append(text)
        self._column += len(text)

    def _new_line(self) -> None:
        self._parts.append("\n  ")
        self._column = 2

    def _text(self) -> str:
        return "".join(self._parts)

    def plain(self, text: str) -> str:
        for word in re.findall(" +|[^ ]+", text):
            if word == " " and self._column > _WIDTH:
                self._new_line()
            else:
                self._write(word)
        return self._text()

    def between(self, text: str) -> str:
        """Between quotes, single ones if they are enough."""
        return self._single(text) if _can_be_single(text) else self.quoted(text)

    def _single(self, text: str) -> str:
        self._write("'")
        at = 0
        for piece in re.findall(" +|\n+|'|[^ \n']+", text):
            at += len(piece)
            if piece[0] == "\n":
                self._parts.append("\n" * len(piece))
                self._new_line()
            elif piece == " " and self._column > _WIDTH and 1 < at < len(text):
                self._new_line()
            else:
                self._write("''" if piece == "'" else piece)
        self._write("'")
        return self._text()

    def quoted(self, text: str) -> str:
        self._write('"')
        pending = ""
        for at, letter in enumerate(text):
            is_escaped = letter in '"\\\ufeff' or not " " <= letter <= "~"
            if is_escaped:
                self._write(pending + _escape(letter))
                pending = ""
            is_full = self._column + len(pending) - is_escaped > _WIDTH
            if is_full and 0 < at < len(text) - 1 and (letter == " " or not pending):
                self._write(pending + "\\")
                self._new_line()
                pending = ""
                if text[at + is_escaped] == " ":
                    self._write("\\")
            if not is_escaped:
                pending += letter
        self._write(pending + '"')
        return self._text()


def _escape(letter: str) -> str:
    if letter in _ESCAPES:
        return "\\" + _ESCAPES[letter]
    code = ord(letter)
    return "\\x%02X" % code if code <= 0xFF else "\\u%04X" % code if code <= 0xFFFF else "\\U%08X" % code
