"""Steps, events and formulas as the log writes them: `spec/agents-semantics.md`, "The log"."""

from agent_queries import form_of
from agent_values import Fault, applied, evaluate, value_of, written

SIGNS = {
    "belief_added": "+", "belief_removed": "-", "goal_added": "+!", "goal_failed": "-!",
    "test_added": "+?", "test_failed": "-?", "perceived": "on ",
}  # fmt: skip
OPERATORS = {
    "add": "+", "sub": "-", "mul": "*", "div": "/", "rem": "%", "eq": "==", "ne": "!=",
    "lt": "<", "le": "<=", "gt": ">", "ge": ">=", "and": "&&", "or": "||",
}  # fmt: skip
COMPARED = ("eq", "ne", "lt", "le", "gt", "ge")
PERFORMATIVES = {"ask_one": "askOne", "ask_all": "askAll"}
CONTROLS = {
    "drop_intention": ".drop_all_intentions", "drop_desire": ".drop_all_desires", "drop_event": ".drop_all_events",
    "suspend": ".suspend",
}  # fmt: skip


def time_text(nanoseconds):
    digits = f"{nanoseconds // 10**9}.{nanoseconds % 10**9:09}".rstrip("0").rstrip(".")
    return f"{digits} s"


def seconds_text(value):
    return f"{value} s"


class Writer:
    """Writes the parts of one agent's plans, with the values that variables have."""

    def __init__(self, program, agent):
        self.program, self.agent = program, agent

    def name_of(self, on):
        """What a trigger is about: `leg` of `+!leg(1)`."""
        ((form, number),) = on.items()
        if form == "perceived":
            return self.program["events"][number]["name"]
        return self.agent["goals" if form.startswith("goal") else "beliefs"][number]["name"]

    def event(self, on, values):
        ((form, _),) = on.items()
        return SIGNS[form] + applied(self.name_of(on), map(written, values))

    def goal(self, on, values):
        """What a frame is for: `!leg(1)` of the plans for `+!leg(1)` and `-!leg(1)`."""
        ((form, _),) = on.items()
        return self.event(on, values)[form.startswith(("goal", "test")) :]

    def fact(self, belief, values):
        return applied(self.agent["beliefs"][belief]["name"], [written(v) for v in values])

    def annotations(self, belief, annotations):
        """`[sure(90), source(self)]`, of values or of terms that are written."""
        if not annotations:
            return ""
        declared = self.agent["beliefs"][belief]["annotations"]
        names = ["source" if a == "source" else declared[a["declared"]]["name"] for a, _ in annotations]
        return "[" + ", ".join(f"{n}({v})" for n, (_, v) in zip(names, annotations)) + "]"

    def selected(self, plan, theta):
        """A plan with the variables that have a value."""
        bound = [f"{name} = {written(theta[n])}" for n, name in enumerate(plan["vars"]) if n in theta]
        return applied(plan["label"], bound) if not bound else f"{plan['label']} ({', '.join(bound)})"

    def step(self, step, theta, called):
        """A step before it is done; of blocks without what comes of their condition."""
        return Here(self, theta, called).step(step["kind"])


class Here:
    """Writes under a θ."""

    def __init__(self, writer, theta, called):
        self.writer, self.theta, self.called = writer, theta, called
        self.program, self.agent = writer.program, writer.agent

    # ── Terms ──

    def value(self, e):
        """The value of an expression; if it has none, the expression."""
        try:
            return written(evaluate(e, self.theta))
        except Fault:
            return self.expression(e)

    def expression(self, e, within=None):
        """An expression as it stands, with the values of what is known; perhaps `within` an operator of a sort."""
        ((form, of),) = e.items()
        if form == "const":
            return written(value_of(of))
        if form == "var":
            return written(self.theta[of]) if of in self.theta else self.called[of]
        if form == "unary":
            is_not = of[0] == "not"
            return ("not " if is_not else "-") + self.expression(of[1], "logical" if is_not else "other")
        if form == "binary":
            here = "logical" if of[0] in ("and", "or") else "other"
            operand = self.value if of[0] in COMPARED else lambda part: self.expression(part, here)
            text = f"{operand(of[1])} {OPERATORS[of[0]]} {operand(of[2])}"
            return f"({text})" if within == "other" or within and of[0] not in COMPARED else text
        if form == "if":
            return f"if {self.value(of[0])} {{ {self.value(of[1])} }} else {{ {self.value(of[2])} }}"
        if form == "call":
            return applied(of[0], [self.value(a) for a in of[1]])
        return self.list([self.value(a) for a in of[0]], self.value(of[1]) if of[1] else None)

    def list(self, elements, rest):
        return f"[{', '.join(elements)}{'' if rest is None else ' | ' + rest}]"

    def term(self, term):
        form, of = form_of(term)
        if form == "any":
            return "_"
        if form == "var":
            return self.value({"var": of})
        if form == "expr":
            return self.value(of)
        return self.list([self.term(t) for t in of[0]], self.term(of[1]) if of[1] else None)

    def terms(self, terms):
        return [self.term(t) for t in terms]

    def values(self, args):
        return [self.value(e) for e in args]

    def literal(self, of, one):
        """A literal, or a belief that is made; `one` writes an argument."""
        name = applied(self.agent["beliefs"][of["belief"]]["name"], map(one, of["args"]))
        return name + self.writer.annotations(of["belief"], [(a, one(t)) for a, t in of["annotations"]])

    # ── Formulas ──

    def formula(self, formula, inner=False):
        form, of = form_of(formula)
        if form == "true":
            return "true"
        if form == "belief":
            return self.literal(of, self.term)
        if form == "not":
            return "not " + self.formula(of, True)
        if form in ("and", "or"):
            text = f" {OPERATORS[form]} ".join(self.formula(part, True) for part in of)
            return f"({text})" if inner and len(of) > 1 else text
        if form == "test":
            return self.expression(of, "logical" if inner else None)
        if form == "unify":
            return f"{self.term(of[0])} = {self.value(of[1])}"
        return self.internal(of[0])

    def internal(self, action):
        form, of = form_of(action)
        out = [self.term(of["out"])] if "out" in of else []
        if form == "find_all":
            name = ".setof" if of["set"] else ".findall"
            return applied(name, [self.value(of["template"]), self.formula(of["formula"])] + out)
        if form == "count":
            return applied(".count", [self.formula(of["formula"])] + out)
        if form == "member":
            return applied(".member", [self.term(of["element"]), self.value(of["list"])])
        if form in ("apply", "holds"):
            name = of["function"]["real"] if isinstance(of["function"], dict) else of["function"]
            name = "string" if name == "to_text" else name
            return applied("." + name, self.values(of["args"]) + out)
        if form in ("intend", "desire", "suspended"):
            return applied("." + form, [applied(self.agent["goals"][of["goal"]]["name"], self.terms(of["args"]))])
        given = [of[part] for part in ("from", "list") if of.get(part)]
        return applied("." + form, self.values(given) + out)

    # ── Steps ──

    def called_goal(self, of):
        return applied(self.agent["goals"][of["goal"]]["name"], self.values(of["args"]))

    def time(self, e):
        """With its unit, if it has a value."""
        try:
            return seconds_text(written(evaluate(e, self.theta)))
        except Fault:
            return self.expression(e)

    def within(self, of, before=" within "):
        return before + self.time(of["within"]) if of["within"] else ""

    def pattern(self, pattern):
        name, args = self.program["events"][pattern["event"]]["name"], pattern["args"]
        if all(a == "any" for a in args):
            return name
        return applied(name, ["_" if a == "any" else written(value_of(a["is"])) for a in args])

    def content(self, of):
        return applied(self.program["contents"][of["content"]]["name"], self.terms(of["args"]))

    def step(self, kind):
        form, of = form_of(kind)
        return getattr(self, "step_" + form)(of)

    def step_do(self, of):
        return applied(self.program["events"][of["event"]]["name"], self.values(of["args"]))

    def step_achieve(self, of):
        return "!" + self.called_goal(of) + self.within(of)

    def step_spawn(self, of):
        return "!!" + self.called_goal(of)

    def step_query(self, of):
        return "?" + self.literal(of, self.term)

    def step_test(self, of):
        form, _ = form_of(of)
        return self.formula(of) if form in ("unify", "internal") else f"?({self.formula(of)})"

    def step_add(self, of):
        return "+" + self.literal(of, self.value)

    def step_remove(self, of):
        return "-" + self.literal(of, self.term)

    def step_replace(self, of):
        return "-+" + self.literal(of, self.value)

    def step_abolish(self, of):
        return f".abolish({self.literal(of, self.term)})"

    def step_await(self, of):
        return "await " + " | ".join(map(self.pattern, of["events"])) + self.within(of)

    def step_wait(self, of):
        return "wait " + self.time(of["seconds"])

    def step_if(self, of):
        return "if"

    def step_while(self, of):
        return "while"

    def step_for(self, of):
        return "for"

    def step_fork(self, of):
        return f"fork: {len(of['branches'])} branches"

    def step_send(self, of):
        performative = PERFORMATIVES.get(of["performative"], of["performative"])
        marks = ", ".join(f"{name}({self.value(e)})" for name, e in of.get("annotations", []))
        what = self.content(of) + (f"[{marks}]" if marks else "")
        if of["to"]:
            return applied(".send", [self.value(of["to"]), performative, what])
        return applied(".broadcast", [performative, what])

    def step_ask(self, of):
        return f".ask({self.value(of['to'])}, {self.content(of)}{self.within(of, ', ')})"

    def step_ask_all(self, of):
        asked = [self.value(of["to"]), self.value(of["template"]), self.content(of), self.term(of["out"])]
        return f".ask_all({', '.join(asked)}{self.within(of, ', ')})"

    def step_print(self, of):
        return applied(".print", self.values(of["args"]))

    def step_control(self, of):
        if of["goal"] is None:
            return CONTROLS[of["what"]]
        goal, args = of["goal"]
        return applied("." + of["what"], [applied(self.agent["goals"][goal]["name"], self.terms(args))])

    def step_fail(self, _):
        return ".fail"
