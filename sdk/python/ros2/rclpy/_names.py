"""Which names are valid, and how they are expanded: the rules of rcl and rmw."""

from __future__ import annotations

_LETTERS = frozenset("abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789_")
_DIGITS = frozenset("0123456789")


def fault_of_node_name(name: str) -> tuple[str, int] | None:
    """What is wrong with a node's name, and where."""
    if not name:
        return "node name must not be empty", 0
    for place, letter in enumerate(name):
        if letter not in _LETTERS:
            return "node name must not contain characters other than alphanumerics or '_'", place
    if name[0] in _DIGITS:
        return "node name must not start with a number", 0
    if len(name) > 255:
        return "node name length should not exceed '255'", 254
    return None


def fault_of_namespace(name: str) -> tuple[str, int] | None:
    """What is wrong with a namespace, and where."""
    if name == "/":
        return None
    found = _fault_of_path(name, "namespace")
    if found is not None and found[0].endswith("end with a '/'"):
        return found[0] + ", unless only a '/'", found[1]
    if found is None and len(name) > 245:
        return "namespace should not exceed '245'", 244
    return found


def fault_of_full_name(name: str) -> tuple[str, int] | None:
    """What is wrong with the full name of a topic or service, and where."""
    found = _fault_of_path(name, "topic name")
    if found is None and len(name) > 247:
        return "topic length should not exceed '247'", 246
    return found


def _fault_of_path(name: str, what: str) -> tuple[str, int] | None:
    if not name:
        return "%s must not be empty" % what, 0
    if name[0] != "/":
        return "%s must be absolute, it must lead with a '/'" % what, 0
    if name[-1] == "/":
        return "%s must not end with a '/'" % what, len(name) - 1
    for place, letter in enumerate(name):
        if letter not in _LETTERS and letter != "/":
            return "%s must not contain characters other than alphanumerics, '_', or '/'" % what, place
    for place in range(1, len(name)):
        if name[place - 1] == "/":
            if name[place] == "/":
                return "%s must not contain repeated '/'" % what, place
            if name[place] in _DIGITS:
                return "%s must not have a token that starts with a number" % what, place
    return None


def fault_of_topic_name(name: str) -> tuple[str, int] | None:
    """What is wrong with the name of a topic or service as a program writes it, and where."""
    if not name:
        return "topic name must not be empty string", 0
    if name[0] in _DIGITS:
        return "topic name token must not start with a number", 0
    if name[-1] == "/":
        return "topic name must not end with a forward slash", len(name) - 1
    found = _fault_of_letters(name)
    if found is not None:
        return found
    for place in range(len(name) - 1):
        if name[place] == "/" and name[place + 1] in _DIGITS:
            return "topic name token must not start with a number", place + 1
        if place == 1 and name[0] == "~" and name[1] != "/":
            return "topic name must not have a tilde '~' that is not followed by a forward slash '/'", 1
    return None


def _fault_of_letters(name: str) -> tuple[str, int] | None:
    opened = -1  # where the last brace is, or -1
    unmatched = "topic name must not have unmatched (unbalanced) curly braces '{}'"
    for place, letter in enumerate(name):
        if letter in _LETTERS:
            if letter in _DIGITS and 0 <= opened == place - 1:
                return "substitution name must not start with a number", place
        elif letter == "}":
            if opened < 0:
                return unmatched, place
            opened = -1
        elif letter == "~" and (place == 0 or opened < 0):
            if place != 0:
                return "topic name must not have tilde '~' unless it is the first character", place
        elif opened >= 0:
            return "substitution name must not contain characters other than alphanumerics or '_'", place
        elif letter == "{":
            opened = place
        elif letter != "/":
            text = "topic name must not contain characters other than alphanumerics, '_', '~', '{', or '}'"
            return text, place
    return None if opened < 0 else (unmatched, opened)


def expanded(name: str, node_name: str, namespace: str) -> str:
    """The full name; raises ValueError where it has none."""
    for fault in (fault_of_topic_name(name), fault_of_node_name(node_name), fault_of_namespace(namespace)):
        if fault is not None:
            raise ValueError(fault[0])
    prefix = namespace if namespace.endswith("/") else namespace + "/"
    if name.startswith("~"):
        name = prefix + node_name + name[1:]
    while "{" in name:
        before, _, rest = name.partition("{")
        inside, _, after = rest.partition("}")
        values = {"node": node_name, "ns": namespace, "namespace": namespace}
        if inside not in values:
            raise ValueError("unknown substitution: {%s}" % inside)
        name = before + values[inside] + after
    return name if name.startswith("/") else prefix + name
