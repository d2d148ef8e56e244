"""What words of the command line mean, as YAML 1.1 reads them: values, and lists and mappings between brackets and braces."""

from __future__ import annotations

import re

TYPE_CHECKING = False
if TYPE_CHECKING:
    from typing import Any

_CONSTANTS: dict[str, Any] = {"": None, "~": None, "null": None, "Null": None, "NULL": None}
for _word in ("yes", "true", "on"):
    _CONSTANTS.update(dict.fromkeys((_word, _word.capitalize(), _word.upper()), True))
for _word in ("no", "false", "off"):
    _CONSTANTS.update(dict.fromkeys((_word, _word.capitalize(), _word.upper()), False))

_INTEGER = re.compile(r"[-+]?(0b[01_]+|0x[0-9a-fA-F_]+|0[0-7_]*|[1-9][0-9_]*)$")
_FLOAT = re.compile(r"[-+]?([0-9][0-9_]*\.[0-9_]*|\.[0-9][0-9_]*)([eE][-+][0-9]+)?$")
_NO_NUMBER = re.compile(r"([-+]?)\.(?:(inf|Inf|INF)|nan|NaN|NAN)$")
_BASES = {"0b": 2, "0x": 16}


def value_of(text: str) -> Any:
    """The value of a word; raises ValueError if there is none."""
    reader = _Reader(text)
    value = reader.value("")
    if reader.rest():
        raise ValueError("there is something behind the value: %s" % text)
    return value


def scalar(text: str) -> Any:
    """What a text without quotes means."""
    if text in _CONSTANTS:
        return _CONSTANTS[text]
    if _INTEGER.match(text):
        return _integer(text.replace("_", ""))
    if _FLOAT.match(text):
        return float(text.replace("_", ""))
    found = _NO_NUMBER.match(text)
    if found and (found.group(2) or not found.group(1)):
        return float(found.group(1) + "inf") if found.group(2) else float("nan")
    return text


def _integer(text: str) -> int:
    sign, digits = (-1 if text[0] == "-" else 1), text.lstrip("+-")
    if digits[:2] in _BASES:
        return sign * int(digits[2:], _BASES[digits[:2]])
    return sign * int(digits, 8 if digits.startswith("0") else 10)


class _Reader:
    """Reads a text from its beginning on."""

    def __init__(self, text: str) -> None:
        self._text, self._place = text, 0

    def rest(self) -> str:
        """What has not been read, without blanks before it."""
        while self._text[self._place : self._place + 1].isspace():
            self._place += 1
        return self._text[self._place :]

    def value(self, ends: str) -> Any:
        """The value that begins here; between brackets, one of these letters ends it."""
        letter = self.rest()[:1]
        if letter == "[":
            return self._list()
        if letter == "{":
            return self._mapping()
        if letter and letter in "\"'":
            return self._quoted(letter)
        if letter and letter in "&*!|>%@`":
            raise ValueError("%s cannot begin a value here; put the value between quotes" % letter)
        text = self._until(ends)
        if not ends and (": " in text or text.endswith(":") or text.startswith("- ")):
            raise ValueError("a mapping stands between braces, a list between brackets: %s" % self._text)
        return scalar(text)

    def _until(self, ends: str) -> str:
        begin = self._place
        while self._place < len(self._text) and self._text[self._place] not in ends:
            if self._text[self._place] == "#" and self._text[self._place - 1 : self._place].isspace():
                found, self._place = self._text[begin : self._place], len(self._text)
                return found.strip()
            self._place += 1
            while self._text[self._place : self._place + 1] == ":" and not self._is_colon():
                self._place += 1
        return self._text[begin : self._place].strip()

    def _is_colon(self) -> bool:
        """Whether the colon here is one between a key and its value, and not one within a word."""
        return self._text[self._place + 1 : self._place + 2] in ("", " ", "\t", "\n", ",", "[", "]", "{", "}")

    def _next(self, end: str) -> bool:
        """Whether there is one more before this bracket, which is passed over."""
        letter = self.rest()[:1]
        if letter not in (",", end):
            raise ValueError("there is no %s where it is due: %s" % (end, self._text))
        self._place += 1
        return letter != end

    def _list(self) -> list[Any]:
        found: list[Any] = []
        self._place += 1
        while self.rest()[:1] != "]":
            found.append(self.value(",]"))
            if not self._next("]"):
                return found
        self._place += 1
        return found

    def _mapping(self) -> dict[Any, Any]:
        found: dict[Any, Any] = {}
        self._place += 1
        while self.rest()[:1] != "}":
            key = self.value(":,}")
            if self.rest()[:1] == ":":
                self._place += 1
                found[key] = self.value(",}")
            else:
                found[key] = None
            if not self._next("}"):
                return found
        self._place += 1
        return found

    def _quoted(self, quote: str) -> str:
        made, place = "", self._place + 1
        while place < len(self._text):
            letter, after = self._text[place], self._text[place + 1 : place + 2]
            place += 1
            if letter == quote and not (quote == after == "'"):
                self._place = place
                return made
            if letter == quote or (letter == "\\" and quote == '"'):
                letter = {"n": "\n", "t": "\t", "r": "\r", "0": "\0"}.get(after, after)
                place += 1
            made += letter
        raise ValueError("a quote is never closed: %s" % self._text)
