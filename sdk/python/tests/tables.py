"""Tables of ROS 1's definitions, as hrdsl writes them into a binding file: of the standard packages, and of more that a test names."""

import functools
import hashlib
import json
import os
import re
import sys
import tempfile
import textwrap

from harness import ROOT, run

sys.path[:0] = [ROOT, os.path.join(ROOT, "ros1")]

FOLDER = os.path.join(ROOT, "..", "..", "stdlib", "messages", "ros1")
PRIMITIVES = set("bool int8 int16 int32 int64 uint8 uint16 uint32 uint64 byte char float32 float64 string time duration".split())
GOAL_TEXTS = {
    "Action": "{0}ActionGoal action_goal\n{0}ActionResult action_result\n{0}ActionFeedback action_feedback\n",
    "ActionGoal": "Header header\nactionlib_msgs/GoalID goal_id\n{0}Goal goal\n",
    "ActionResult": "Header header\nactionlib_msgs/GoalStatus status\n{0}Result result\n",
    "ActionFeedback": "Header header\nactionlib_msgs/GoalStatus status\n{0}Feedback feedback\n",
}


@functools.lru_cache(None)
def standard():
    """The texts of the standard packages by their file names, such as `std_msgs/msg/Bool.msg`."""
    found = {}
    for name in sorted(os.listdir(FOLDER)):
        with open(os.path.join(FOLDER, name)) as file:
            for part in re.split(r"^== ", file.read(), flags=re.M)[1:]:
                head, _, text = part.partition("\n")
                found["%s/%s" % (name[:-4], head.strip())] = text
    return found


def table(packages, **more):
    """All definitions of these packages, and what they hold; `more` are texts by package__Name, as of a .msg, .srv or .action."""
    texts = dict(standard())
    packages = set(packages)
    for name, text in more.items():
        package, own = name.split("__")
        parts = len(re.split(r"^---", text, flags=re.M))
        kind = {1: "msg", 2: "srv", 3: "action"}[parts]
        texts["%s/%s/%s.%s" % (package, kind, own, kind)] = text
        packages.add(package)
    return _Maker(texts).make(packages)


class _Maker:
    def __init__(self, texts):
        self.texts, self.made, self.spaces = {}, {}, {}
        self.services, self.actions = [], []
        for file, text in texts.items():
            package, kind, own = file.split("/")
            own, name = own.rpartition(".")[0], "%s/%s" % (package, own.rpartition(".")[0])
            if kind == "msg":
                self._text(name, text, "msg")
                continue
            parts = [part.strip("\n") + "\n" if part.strip() else "" for part in re.split(r"^---.*$", text, flags=re.M)]
            ends = ("Request", "Response") if kind == "srv" else ("Goal", "Result", "Feedback")
            for end, part in zip(ends, parts):
                self._text(name + end, part, "srv" if kind == "srv" else "msg")
            if kind == "srv":
                self.services.append(name)
            else:
                self.actions.append(name)
                for end, part in GOAL_TEXTS.items():
                    self._text(name + end, part.format(own), "msg")

    def _text(self, name, text, space):
        self.texts[name], self.spaces[name] = text, space

    def make(self, packages):
        for name in self.texts:
            if name.split("/")[0] in packages:
                self.message(name)
        inside = lambda name: name.split("/")[0] in packages  # noqa: E731
        return {
            "version": 1,
            "ros": 1,
            "messages": list(self.made.values()),
            "services": [self.service(name) for name in self.services if inside(name)],
            "actions": [self.action(name) for name in self.actions if inside(name)],
        }

    def service(self, name):
        texts = self.sum_text(name + "Request") + self.sum_text(name + "Response")
        md5 = hashlib.md5(texts.encode()).hexdigest()
        return {"name": name, "request": name + "Request", "response": name + "Response", "md5": md5}

    def action(self, name):
        keys = dict(goal="Goal", result="Result", feedback="Feedback", action="Action", action_goal="ActionGoal",
                    action_result="ActionResult", action_feedback="ActionFeedback")  # fmt: skip
        found = {key: name + end for key, end in keys.items()}
        return {"name": name, **found, "cancel": "actionlib_msgs/GoalID", "status": "actionlib_msgs/GoalStatusArray"}

    def message(self, name):
        if name in self.made:
            return self.made[name]
        package = name.split("/")[0]
        made = {"name": name, "package": package, "space": self.spaces[name], "constants": [], "fields": []}
        made.update(text=self.texts[name], holds=[])
        for line in self.texts[name].splitlines():
            constant = re.match(r"\s*(\w+)\s+(\w+)\s*=\s*(.*?)\s*$", line)
            if constant and not line.strip().startswith("#"):
                made["constants"].append(self.constant(*constant.groups()))
                continue
            words = line.partition("#")[0].split()
            if words:
                made["fields"].append(self.field(package, *words, made["holds"]))
        made["md5"] = hashlib.md5(self.sum_text(name, made).encode()).hexdigest()
        self.made[name] = made
        return made

    def constant(self, kind, name, value):
        if kind != "string":
            value = value.partition("#")[0].strip()
            value = float(value) if kind.startswith("float") else value == "True" if kind == "bool" else int(value, 0)
        return {"name": name, "type": kind, "value": value}

    def field(self, package, kind, name, holds):
        base, _, count = kind.partition("[")
        if base == "Header":
            base = "std_msgs/Header"
        elif base not in PRIMITIVES and "/" not in base:
            base = "%s/%s" % (package, base)
        if base not in PRIMITIVES:
            for each in [base] + self.message(base)["holds"]:
                if each not in holds:
                    holds.append(each)
        found = {"name": name, "type": base}
        if "[" in kind:
            found["array"] = {"exactly": int(count[:-1])} if count != "]" else "any"
        return found

    def sum_text(self, name, made=None):
        made = made or self.message(name)
        lines = []
        for line in made["text"].splitlines():
            constant = re.match(r"\s*(\w+)\s+(\w+)\s*=\s*(.*?)\s*$", line)
            if constant and not line.strip().startswith("#"):
                kind, own, value = constant.groups()
                lines.append("%s %s=%s" % (kind, own, value if kind == "string" else value.partition("#")[0].strip()))
        for field in made["fields"]:
            if field["type"] in PRIMITIVES:
                array = field.get("array")
                end = "" if array is None else "[%s]" % ("" if array == "any" else array["exactly"])
                lines.append("%s%s %s" % (field["type"], end, field["name"]))
            else:
                lines.append("%s %s" % (self.message(field["type"])["md5"], field["name"]))
        return "\n".join(lines)


def bound(folder, of, more=(), **keys):
    """Writes a binding file, and says what the environment of a program needs."""
    path = os.path.join(folder, "binding.json")
    with open(path, "w") as file:
        json.dump({"ros": 1, "interfaces": table(of, **dict(more)), **keys}, file)
    return {"HRDSL_BINDING": path, "HRDSL_MIDDLEWARE": "ros1"}


def run_ros(text, packages=("std_msgs",), system=None, more=(), words=(), env=(), binding=(), files=()):
    """Runs a program of ROS 1 of this text; `binding` is more of its binding file, and `files` are beside it."""
    with tempfile.TemporaryDirectory() as folder:
        for name, content in dict(files).items():
            os.makedirs(os.path.join(folder, os.path.dirname(name)), exist_ok=True)
            with open(os.path.join(folder, name), "w") as file:
                file.write(content)
        path = os.path.join(folder, "node.py")
        with open(path, "w") as file:
            file.write(textwrap.dedent(text))
        return run([path, *words], system=system, env={**bound(folder, packages, more, **dict(binding)), **dict(env)})
