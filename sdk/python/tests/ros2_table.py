"""The table of definitions (spec/messages.md) of ROS 2's standard packages, as the binding file has it, and of those of a test."""

import json
import os

FOLDER = os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "..", "..", "stdlib", "messages", "ros2")

PRIMITIVE = set(
    "bool byte char float32 float64 int8 uint8 int16 uint16 int32 uint32 int64 uint64 string wstring".split()
)

#: What the tests use, beside what rclpy needs itself.
PACKAGES = (
    "action_msgs builtin_interfaces example_interfaces geometry_msgs nav_msgs rcl_interfaces sensor_msgs std_msgs std_srvs "
    "tf2_msgs trajectory_msgs unique_identifier_msgs"
).split()

#: A package of the tests' own.
OWN = """\
== msg/Odd.msg
byte flag 7
char letter
bool[] truths
byte[2] pair
string<=5 short "abc"
string[<=2] few
int32[] numbers [1, -2]
float32 single 0.5
float32[] singles
float64[3] place
uint8[4] key
string from
std_msgs/Header[] headers
wstring wide
int8 LEFT=-1
string GREETING="hello"
== msg/Nothing.msg
"""


def table(packages=PACKAGES):
    made = {"version": 1, "ros": 2, "messages": [], "services": [], "actions": []}
    for package in packages:
        with open(os.path.join(FOLDER, package + ".txt")) as file:
            read_package(package, file.read(), made)
    read_package("odd_msgs", OWN, made)
    return made


def read_package(package, text, made):
    for section in ("\n" + text).split("\n== ")[1:]:
        path, _, body = section.partition("\n")
        space, _, file = path.partition("/")
        name = file.partition(".")[0]
        parts = [[]]
        for line in body.splitlines():
            if line.strip() == "---":
                parts.append([])
            else:
                parts[-1].append(line)
        full = "%s/%s/" % (package, space)
        if space == "msg":
            made["messages"].append(message(full + name, package, space, parts[0]))
            continue
        kinds = ("Request", "Response") if space == "srv" else ("Goal", "Result", "Feedback")
        names = {}
        for kind, lines in zip(kinds, parts):
            names[kind.lower()] = "%s%s_%s" % (full, name, kind)
            made["messages"].append(message(names[kind.lower()], package, space, lines))
        made["services" if space == "srv" else "actions"].append({"name": full + name, **names})


def message(name, package, space, lines):
    fields, constants = [], []
    for line in lines:
        line = line.strip()
        if not line or line.startswith("#"):
            continue
        kind, _, rest = line.partition(" ")
        own, equals, value = rest.partition("=")
        if equals and own.strip().isupper():
            constants.append({"name": own.strip(), "type": kind, "value": parsed(kind, value.strip())})
        else:
            fields.append(field(kind, rest.strip(), package))
    return {
        "name": name,
        "package": package,
        "space": space,
        "constants": constants,
        "fields": fields,
        "text": "\n".join(lines),
    }


def field(kind, rest, package):
    name, _, default = rest.partition(" ")
    made = {"name": name}
    if kind.endswith("]"):
        kind, _, size = kind[:-1].rpartition("[")
        made["array"] = "any" if not size else {"at_most": int(size[2:])} if "<" in size else {"exactly": int(size)}
    kind, bounded, most = kind.partition("<=")
    if bounded:
        made["characters"] = int(most)
    if kind not in PRIMITIVE:
        parts = kind.split("/")
        kind = "%s/msg/%s" % (parts[0] if len(parts) > 1 else package, parts[-1])
    made["type"] = kind
    if default.strip():
        made["default"] = parsed(kind, default.strip())
    return made


def parsed(kind, text):
    if text[0] in "[\"":
        return json.loads(text)
    if kind in ("string", "wstring"):
        return text
    if kind == "bool":
        return text.lower() in ("true", "1")
    return float(text) if kind.startswith("float") else int(text, 0)
