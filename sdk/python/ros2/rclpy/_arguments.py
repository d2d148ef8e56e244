"""What comes after `--ros-args`: remappings, parameters, levels of the log."""

from __future__ import annotations

from rclpy import _names, _yaml
from rclpy._rclpy_pybind11 import RCLInvalidROSArgsError, UnknownROSArgsError

TYPE_CHECKING = False  # as type checkers read it; importing `typing` takes long
if TYPE_CHECKING:
    from typing import Any, Callable, Iterable

_SHORT = {"-r": "--remap", "-p": "--param", "-e": "--enclave"}
_IGNORED = ("--enclave", "--log-config-file", "--log-file-name")
_SWITCHES = ("stdout-logs", "rosout-logs", "external-lib-logs")


class Rule:
    """A remapping: of topics and services, or (`__node`, `__ns`) of nodes."""

    __slots__ = ("kinds", "node", "match", "replacement")

    def __init__(self, kinds: tuple[str, ...], node: str | None, match: str, replacement: str) -> None:
        self.kinds, self.node, self.match, self.replacement = kinds, node, match, replacement


class Arguments:
    """What was said after `--ros-args`, and the rest."""

    def __init__(self, words: Iterable[Any]) -> None:
        self.rules: list[Rule] = []
        self.parameters: dict[str, dict[str, Any]] = {}  # by the patterns of the nodes' names
        self.levels: list[tuple[str, int]] = []
        self.others: list[str] = []  # which are the program's own
        self.deprecated: list[str] = []
        self.is_silent = False
        self._unknown: list[str] = []
        self._read([str(word) for word in words])
        if self._unknown:
            raise UnknownROSArgsError(repr(self._unknown))

    def _read(self, words: list[str]) -> None:
        place, inside = 0, False
        while place < len(words):
            word = words[place]
            place += 1
            if not inside:
                if word == "--ros-args":
                    inside = True
                elif not self._deprecated_rule(word):
                    self.others.append(word)
            elif word == "--":
                inside = False
            elif word != "--ros-args":
                place += self._option(word, words[place : place + 1])

    def _option(self, word: str, rest: list[str]) -> int:
        """Reads an option, and says how many words follow that belong to it."""
        option = _SHORT.get(word, word)
        what = {
            "--remap": ("remap rule", "No remap rule found.", self._remap),
            "--param": ("parameter override rule", "No parameter override rule found.", self._parameter),
            "--params-file": ("params file", "No file path provided.", self._file),
            "--log-level": ("log level", "No log level provided.", self._level),
        }.get(option)
        if what is not None:
            kind, missing, read = what
            if not rest:
                raise _fault("Couldn't parse trailing %s flag. %s" % (word, missing))
            try:
                read(rest[0])
            except (ValueError, OSError) as error:
                raise _fault("Couldn't parse %s: '%s %s'. Error: %s" % (kind, word, rest[0], error)) from None
            return 1
        if option in _IGNORED:
            return 1
        verb, _, switch = word.removeprefix("--").partition("-")
        if verb in ("enable", "disable") and switch in _SWITCHES:
            if switch == "stdout-logs":
                self.is_silent = verb == "disable"
        else:
            self._unknown.append(word)
        return 0

    def _deprecated_rule(self, word: str) -> bool:
        if ":=" not in word:
            return False
        try:
            self._remap(word)
        except ValueError:
            return False
        self.deprecated.append(word)
        return True

    def _remap(self, text: str) -> None:
        match, separator, replacement = text.partition(":=")
        if not separator or not match or not replacement:
            raise ValueError("a remap rule is FROM:=TO")
        node: str | None = None
        kinds: tuple[str, ...] = ("topic", "service")
        if ":" in match and not match.startswith(("rostopic://", "rosservice://")):
            node, _, match = match.partition(":")
            if _names.fault_of_node_name(node) is not None:
                raise ValueError("%r is no name of a node" % node)
        for prefix, kind in (("rostopic://", "topic"), ("rosservice://", "service")):
            if match.startswith(prefix):
                kinds, match = (kind,), match.removeprefix(prefix)
        if match in ("__node", "__name"):
            fault, kinds = _names.fault_of_node_name(replacement), ("node",)
        elif match == "__ns":
            fault, kinds = _names.fault_of_namespace(replacement), ("ns",)
        else:
            fault = _names.fault_of_topic_name(match) or _names.fault_of_topic_name(replacement)
        if fault is not None:
            raise ValueError(fault[0])
        self.rules.append(Rule(kinds, node, match, replacement))

    def _parameter(self, text: str) -> None:
        name, separator, value = text.partition(":=")
        node, colon, after = name.partition(":")
        if not colon:
            node, after = "/**", name
        if not separator or not after or not node:
            raise ValueError("a parameter rule is NAME:=VALUE")
        self._put(node, after, _yaml.parse_value(value), 1)

    def _file(self, path: str) -> None:
        with open(path, encoding="utf-8") as file:
            document = _yaml.parse(file.read())
        if document is None:
            return
        if not isinstance(document, dict):
            raise ValueError("%s: there are no names of nodes" % path)
        self._nodes(document, "", path)

    def _nodes(self, mapping: dict[str, Any], prefix: str, path: str) -> None:
        for key, below in mapping.items():
            if not isinstance(below, dict):
                raise ValueError("%s: Cannot have a value before ros__parameters" % path)
            if key != "ros__parameters":
                self._nodes(below, (prefix + "/" + key).replace("//", "/") if prefix else key, path)
            elif not prefix:
                raise ValueError("%s: There are no node names before ros__parameters" % path)
            else:
                self._parameters(prefix, below, "")

    def _parameters(self, node: str, mapping: dict[str, Any], prefix: str) -> None:
        for key, value in mapping.items():
            if isinstance(value, dict):
                self._parameters(node, value, prefix + key + ".")
            else:
                self._put(node, prefix + key, value, 0)

    def _put(self, node: str, name: str, value: Any, line: int) -> None:
        if isinstance(value, dict):
            self._parameters(node, value, name + ".")
            return
        if isinstance(value, list) and value:
            kinds = {type(each) for each in value}
            if len(kinds) > 1 or not kinds <= {bool, int, float, str}:
                raise ValueError("Sequence should be of same type: parameter %s" % name)
        pattern = node if node.startswith("/") else "/" + node
        self.parameters.setdefault(pattern, {})[name] = value

    def _level(self, text: str) -> None:
        from rclpy.impl.logging_severity import LoggingSeverity

        name, separator, level = text.partition(":=")
        if not separator:
            name, level = "", text
        if level.upper() not in LoggingSeverity.__members__ or (separator and not name):
            raise ValueError("a level is debug, info, warn, error or fatal")
        self.levels.append((name, LoggingSeverity[level.upper()]))


def _fault(text: str) -> RCLInvalidROSArgsError:
    return RCLInvalidROSArgsError("Failed to parse ROS arguments: %s" % text)


def matches(pattern: str, name: str) -> bool:
    """Whether a node's full name matches a pattern, where `*` is one part and `**` any number of them."""
    return _parts_match(pattern.split("/")[1:], name.split("/")[1:])


def _parts_match(pattern: list[str], parts: list[str]) -> bool:
    if not pattern:
        return not parts
    if pattern[0] == "**":
        return any(_parts_match(pattern[1:], parts[count:]) for count in range(len(parts) + 1))
    return bool(parts) and pattern[0] in ("*", parts[0]) and _parts_match(pattern[1:], parts[1:])


def parameters_of(sources: list[Arguments], name: str) -> dict[str, Any]:
    """The parameters that are given to the node of this full name; later ones count."""
    found: dict[str, Any] = {}
    for source in sources:
        for pattern, values in source.parameters.items():
            if matches(pattern, name):
                found.update(values)
    return found


def remapped(
    sources: list[Arguments], kind: str, name: str, node: str, expand: Callable[[str], str] | None = None
) -> str:
    """What becomes of a name by the first rule that fits: those of the node itself come first in `sources`."""
    for source in sources:
        for rule in source.rules:
            if kind not in rule.kinds or rule.node not in (None, node):
                continue
            if expand is None:
                return rule.replacement
            if expand(rule.match) == name:
                return expand(rule.replacement)
    return name
