"""Files of parameters: as much of YAML as they use, with values as rcl reads them.

Mappings and lists, in blocks or between braces and brackets, plain and quoted texts, comments. Anchors, tags and texts of
several lines are refused.
"""

from __future__ import annotations

TYPE_CHECKING = False  # as type checkers read it; importing `typing` takes long
if TYPE_CHECKING:
    from typing import Any, NoReturn

_TRUE = {"Y", "y", "yes", "Yes", "YES", "true", "True", "TRUE", "on", "On", "ON"}
_FALSE = {"N", "n", "no", "No", "NO", "false", "False", "FALSE", "off", "Off", "OFF"}
_FLOATS = {".nan": "nan", ".inf": "inf", "+.inf": "inf", "-.inf": "-inf"}
_DEPTH = 100
_ESCAPES = {"n": "\n", "t": "\t", "r": "\r", "0": "\0", '"': '"', "\\": "\\", "/": "/", "e": "\x1b", " ": " "}


class YamlError(ValueError):
    """What cannot be read, and where."""


class _Line:
    __slots__ = ("number", "indent", "text")

    def __init__(self, number: int, indent: int, text: str) -> None:
        self.number, self.indent, self.text = number, indent, text


def parse(text: str) -> Any:
    """The value of a document; an empty one is None."""
    lines = []
    for number, line in enumerate(text.splitlines(), 1):
        bare = _without_comment(line).rstrip()
        stripped = bare.lstrip(" ")
        if not stripped or (number == 1 and stripped.startswith("%")) or bare == "---":
            continue
        if stripped.startswith("\t"):
            _refuse("a tab cannot indent", number)
        if bare in ("...", "--- ") or bare.startswith("--- "):
            _refuse("a file of parameters is one document, which begins in a line of its own", number)
        lines.append(_Line(number, len(bare) - len(stripped), stripped))
    if not lines:
        return None
    reader = _Blocks(lines)
    value = reader.block(lines[0].indent, 0)
    if reader.place < len(lines):
        _refuse("this line is indented otherwise than those before", lines[reader.place].number)
    return value


def parse_value(text: str) -> Any:
    """The value of one text, as after `name:=`."""
    bare = text.strip()
    if not bare:
        raise YamlError("No value at line 1")
    if bare[0] in "[{\"'":
        return _Flow(bare, 1).whole()
    return scalar(bare)


def scalar(text: str) -> Any:
    """What a text without quotes stands for."""
    if text in _TRUE:
        return True
    if text in _FALSE:
        return False
    number = _integer(text)
    if number is not None:
        return number
    try:
        if text.lower() in _FLOATS:
            return float(_FLOATS[text.lower()])
        if "_" not in text:
            return float(text)
    except ValueError:
        pass
    return text


def _integer(text: str) -> int | None:
    digits = text.lstrip("+-")
    if len(text) - len(digits) > 1 or not digits.isascii() or "_" in digits:
        return None
    try:
        if digits[:2].lower() == "0x":
            value = int(digits, 16)
        elif digits.startswith("0") and len(digits) > 1:
            value = int(digits, 8)
        else:
            value = int(digits)
    except ValueError:
        return None
    value = -value if text.startswith("-") else value
    return value if -(2**63) <= value < 2**63 else None


def _refuse(what: str, number: int) -> NoReturn:
    raise YamlError("%s at line %d" % (what, number))


def _without_comment(line: str) -> str:
    if "#" not in line:
        return line
    quote, place = "", 0
    while place < len(line):
        letter = line[place]
        if quote:
            if quote == line[place : place + 2][1:] == letter == "'" or (letter == "\\" and quote == '"'):
                place += 1  # a quote in the text, which does not end it
            elif letter == quote:
                quote = ""
        elif letter in "\"'" and (place == 0 or line[place - 1] in " [{,:-"):
            quote = letter
        elif letter == "#" and (place == 0 or line[place - 1] in " \t"):
            return line[:place]
        place += 1
    return line


def _key_end(text: str) -> int:
    """Where the colon after a key is, or -1."""
    quote = ""
    for place, letter in enumerate(text):
        if quote:
            quote = "" if letter == quote else quote
        elif letter in "\"'" and place == 0:
            quote = letter
        elif letter == ":" and (place + 1 == len(text) or text[place + 1] in " \t"):
            return place
    return -1


class _Blocks:
    """Reads what is laid out by indentation."""

    def __init__(self, lines: list[_Line]) -> None:
        self._lines = lines
        self.place = 0

    def _next(self) -> _Line | None:
        return self._lines[self.place] if self.place < len(self._lines) else None

    def block(self, indent: int, depth: int) -> Any:
        """The mapping, list or value that begins in the next line."""
        line = self._lines[self.place]
        if depth > _DEPTH:
            _refuse("there are more than %d levels" % _DEPTH, line.number)
        if line.text == "-" or line.text.startswith("- "):
            return self._list(indent, depth)
        if _key_end(line.text) < 0 or line.text[0] in "[{":
            self.place += 1
            return self._inline(line, line.text)
        return self._mapping(indent, depth)

    def _mapping(self, indent: int, depth: int) -> dict[str, Any]:
        found: dict[str, Any] = {}
        while True:
            line = self._next()
            if line is None or line.indent != indent or line.text == "-" or line.text.startswith("- "):
                return found
            end = _key_end(line.text)
            if end < 0:
                _refuse("there is no key, which ends with a colon and a space,", line.number)
            key = line.text[:end].strip()
            if key[:1] in "\"'":
                key = str(_Flow(key, line.number).whole())
            self.place += 1
            found[key] = self._after(line, line.text[end + 1 :].strip(), indent, depth)

    def _list(self, indent: int, depth: int) -> list[Any]:
        found = []
        while True:
            line = self._next()
            if line is None or line.indent != indent or not (line.text == "-" or line.text.startswith("- ")):
                return found
            rest = line.text[1:].strip()
            if rest and rest[0] not in "[{\"'" and _key_end(rest) >= 0:
                _refuse("a list of parameters holds values, and no mappings,", line.number)
            self.place += 1
            found.append(self._after(line, rest, indent + 1, depth))

    def _after(self, line: _Line, text: str, indent: int, depth: int) -> Any:
        """The value after a key or a dash: in the line, or in the lines below."""
        if text:
            return self._inline(line, text)
        below = self._next()
        if below is not None and (below.indent > indent or (below.indent == indent and below.text.startswith("- "))):
            return self.block(below.indent, depth + 1)
        _refuse("No value", line.number)

    def _inline(self, line: _Line, text: str) -> Any:
        if text[0] in "|>":
            _refuse("texts of several lines are not supported; write them between quotes,", line.number)
        if text[0] in "&*!":
            if text.startswith("!!str "):
                return text[6:].strip().strip("\"'")
            _refuse("anchors and tags are not supported", line.number)
        if text[0] not in "[{\"'":
            return scalar(text)
        while text[0] in "[{" and _Flow(text, line.number).is_open():
            more = self._next()
            if more is None:
                _refuse("a bracket is never closed", line.number)
            text += " " + more.text
            self.place += 1
        return _Flow(text, line.number).whole()


class _Flow:
    """Reads what stands between brackets, braces or quotes."""

    def __init__(self, text: str, number: int) -> None:
        self._text = text
        self._number = number
        self._place = 0

    def is_open(self) -> bool:
        """Whether a bracket waits for its other one."""
        count, quote = 0, ""
        for letter in self._text:
            if quote:
                quote = "" if letter == quote else quote
            elif letter in "\"'":
                quote = letter
            else:
                count += (letter in "[{") - (letter in "]}")
        return count > 0

    def whole(self) -> Any:
        """The value, which is all of the text."""
        value = self._value(0)
        if self._peek():
            _refuse("there is something after the value", self._number)
        return value

    def _peek(self) -> str:
        while self._place < len(self._text) and self._text[self._place] in " \t":
            self._place += 1
        return self._text[self._place : self._place + 1]

    def _value(self, depth: int) -> Any:
        letter = self._peek()
        if depth > _DEPTH:
            _refuse("there are more than %d levels" % _DEPTH, self._number)
        if letter == "[":
            return self._list(depth)
        if letter == "{":
            return self._mapping(depth)
        return self._quoted(letter) if letter and letter in "\"'" else self._plain()

    def _list(self, depth: int) -> list[Any]:
        found = []
        self._place += 1
        while self._peek() != "]":
            found.append(self._value(depth + 1))
            self._separate("]")
        self._place += 1
        return found

    def _mapping(self, depth: int) -> dict[str, Any]:
        found = {}
        self._place += 1
        while self._peek() != "}":
            letter = self._peek()
            key = self._quoted(letter) if letter in "\"'" else self._until(":,}]")
            if self._peek() != ":":
                _refuse("there is no colon after a key", self._number)
            self._place += 1
            found[key] = self._value(depth + 1)
            self._separate("}")
        self._place += 1
        return found

    def _separate(self, end: str) -> None:
        letter = self._peek()
        if letter == ",":
            self._place += 1
        elif letter != end:
            _refuse("there is no %s" % end, self._number)

    def _until(self, ends: str) -> str:
        begin = self._place
        while self._place < len(self._text) and self._text[self._place] not in ends:
            self._place += 1
        return self._text[begin : self._place].strip()

    def _plain(self) -> Any:
        text = self._until(",]}")
        if not text:
            _refuse("No value", self._number)
        return scalar(text)

    def _quoted(self, quote: str) -> str:
        made, place = "", self._place + 1
        while place < len(self._text):
            letter = self._text[place]
            after = self._text[place + 1 : place + 2]
            if letter == quote == "'" and after == "'":
                made += "'"
                place += 1
            elif letter == quote:
                self._place = place + 1
                return made
            elif letter == "\\" and quote == '"':
                if after not in _ESCAPES:
                    _refuse("\\%s is not supported" % after, self._number)
                made += _ESCAPES[after]
                place += 1
            else:
                made += letter
            place += 1
        _refuse("a quote is never closed", self._number)
