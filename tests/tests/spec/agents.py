"""Agents and the harness as `spec/agents.md` and `spec/harness.md` define them, rule by rule, and slowly.

Reads a program and the players of a run as JSON, and prints the trace of the run. Nothing here is taken from the code of hrdsl:
where the two differ, one of them or the specification is wrong.
"""

import json
import sys

UNIT = 10**9  # nanoseconds in a second


class Fault(Exception):
    """An expression without a value, a term that cannot be matched."""


class Failed(Exception):
    """A step that fails."""


def kind(v):
    return "bool" if isinstance(v, bool) else "number" if isinstance(v, (int, float)) else "name"


def alike(v, w):
    """v ≈ w, for values whose floats are no zeros or NaNs."""
    return kind(v) == kind(w) and v == w


def evaluate(e, names):
    """names ⊢ e ⇓ the result."""
    ((form, of),) = e.items()
    if form == "const":
        return of
    if form == "var":
        if of not in names:
            raise Fault
        return names[of]
    if form == "if":
        return evaluate(of[1] if evaluate(of[0], names) else of[2], names)
    if form == "unary":
        value = evaluate(of[1], names)
        return not value if of[0] == "not" else -value
    if form == "binary":
        op, left, right = of
        a = evaluate(left, names)
        if op in ("and", "or") and a == (op == "or"):
            return a
        b = evaluate(right, names)
        if op in ("and", "or"):
            return b
        if op in ("div", "rem") and b == 0:
            raise Fault
        if op in ("div", "rem") and isinstance(a, int) and isinstance(b, int):
            whole = abs(a) // abs(b) * (1 if (a < 0) == (b < 0) else -1)
            return whole if op == "div" else a - b * whole
        compared = {"eq": a == b, "ne": a != b}
        if op in compared:
            return compared[op]
        return {
            "add": lambda: a + b, "sub": lambda: a - b, "mul": lambda: a * b, "div": lambda: a / b,
            "lt": lambda: a < b, "le": lambda: a <= b, "gt": lambda: a > b, "ge": lambda: a >= b,
        }[op]()
    if form == "call":
        values = [evaluate(a, names) for a in of[1]]
        pick = {"abs": lambda: abs(*values), "norm": lambda: sum(v * v for v in values) ** 0.5}
        pick["min"] = lambda: values[0] if values[0] <= values[1] else values[1]
        pick["max"] = lambda: values[0] if values[0] >= values[1] else values[1]
        return pick[of[0]]()
    raise NotImplementedError(form)


def reads(e):
    if isinstance(e, dict):
        return [e["var"]] if "var" in e else [v for part in e.values() for v in reads(part)]
    return [v for part in e for v in reads(part)] if isinstance(e, list) else []


def well_bound(terms, theta):
    known = set(theta)
    for term in terms:
        if term != "any" and "expr" in term and not known.issuperset(reads(term["expr"])):
            raise Fault
        if term != "any" and "var" in term:
            known.add(term["var"])


OPEN = object()


def match(terms, values, theta):
    """θ ⊢ (terms) = (values) ⇒ the result, or None."""
    theta = dict(theta)
    for term, value in zip(terms, values):
        if value is OPEN or term == "any":
            continue
        if "var" in term and term["var"] not in theta:
            theta[term["var"]] = value
        elif not alike(theta[term["var"]] if "var" in term else evaluate(term["expr"], theta), value):
            return None
    return theta


def answers(context, theta, base):
    """The answers of a context, in order."""
    if context == "true":
        yield theta
        return
    ((form, of),) = context.items()
    if form == "belief":
        well_bound(of["args"], theta)
        for fact in list(base[of["belief"]]):
            found = match(of["args"], fact, theta)
            if found is not None:
                yield found
    elif form == "and":
        if not of:
            yield theta
        else:
            for found in answers(of[0], theta, base):
                yield from answers({"and": of[1:]}, found, base)
    elif form == "or":
        for part in of:
            yield from answers(part, theta, base)
    elif form == "not":
        if next(answers(of, theta, base), None) is None:
            yield theta
    elif form == "test":
        if evaluate(of, theta):
            yield theta


def typed(params, values):
    if len(params) != len(values):
        raise Failed
    out = []
    for param, value in zip(params, values):
        ty = param["ty"]
        if ty == "bool":
            fits = kind(value) == "bool"
        elif "int" in ty:
            fits = kind(value) == "number" and isinstance(value, int) and ty["int"]["lo"] <= value <= ty["int"]["hi"]
        else:
            value, fits = float(value), True
        if not fits:
            raise Failed
        out.append(value)
    return out


def fits(patterns, event, args):
    same = lambda p, v: p == "any" or alike(p["is"], v)
    return any(p["event"] == event and all(map(same, p["args"], args)) for p in patterns)


class Frame:
    def __init__(self, plan, values, theta):
        self.plan, self.next, self.values, self.theta = plan, 0, values, theta


class Intention:
    def __init__(self):
        self.frames = []


class Agent:
    def __init__(self, program, number, chosen):
        self.program, self.it = program, program["agents"][number]
        self.actor, self.now, self.serial, self.stimuli = self.it["actor"], 0, 0, []
        self.B = {b: [] for b in range(len(self.it["beliefs"]))}
        self.E, self.R, self.N, self.W, self.A, self.given = [], [], [], [], [], []
        self.timed = {}  # whose timer it is, by when it was set
        for fact in self.it["initial_beliefs"] + chosen:
            self.add(fact["belief"], fact["args"])
        for goal, values in self.it["initial_goals"]:
            self.post({"goal_added": goal}, values, None)

    # ── the parts of the cycle ──

    def relevant(self, on):
        return [p for p in self.it["plans"] if p["trigger"]["on"] == on]

    def post(self, on, values, i):
        self.E.append((on, values, i))

    def announce(self, on, values):
        if self.relevant(on):
            self.post(on, values, None)

    def settle(self):
        while True:
            if not self.E and not self.R:
                if not self.N:
                    return
                self.take_in(*self.N.pop(0))
                continue
            if self.E:
                self.deliberate(*self.E.pop(0))
            if self.R:
                self.step(self.R.pop(0))

    def expire(self):
        for timer in sorted(w for w in self.W if w[0] <= self.now):
            self.W.remove(timer)
            i = self.timed[timer[1]]
            awaiting = [a for a in self.A if a[0] is i]
            if awaiting:
                self.A.remove(awaiting[0])
                self.fail(i)
            else:
                self.resume(i)

    def set_timer(self, i, time):
        self.serial += 1
        self.timed[self.serial] = i
        self.W.append((self.now + time, self.serial))
        return self.W[-1]

    def take_in(self, event, args):
        for waiting in list(self.A):
            i, patterns, timer = waiting
            if fits(patterns, event, args):
                self.A.remove(waiting)
                if timer:
                    self.W.remove(timer)
                self.resume(i)
        self.announce({"perceived": event}, args)

    def select(self, on, values):
        for plan in self.relevant(on):
            try:
                terms = plan["trigger"]["args"]
                well_bound(terms, {})
                first = match(terms, values, {})
                found = None if first is None else next(answers(plan["context"], first, self.B), None)
            except Fault:
                continue
            if found is not None:
                return Frame(plan, values, found)
        return None

    def deliberate(self, on, values, i):
        frame = self.select(on, values)
        if frame:
            i = i or Intention()
            i.frames.append(frame)
            self.resume(i)
        elif "goal_added" in on:
            i = i or Intention()
            frame = self.select({"goal_failed": on["goal_added"]}, values)
            if frame:
                i.frames.append(frame)
                self.resume(i)
            else:
                self.fail(i)
        elif "test_added" in on:
            self.fail(i)

    def resume(self, i):
        while i.frames:
            top = i.frames[-1]
            if top.next < len(top.plan["body"]):
                self.R.append(i)
                return
            i.frames.pop()
            if "test_added" in top.plan["trigger"]["on"]:
                try:
                    self.answer(i, top)
                except (Fault, Failed):
                    self.fail(i)
                    return

    def answer(self, i, top):
        below = i.frames[-1]
        query = below.plan["body"][below.next - 1]["kind"]["query"]
        values = []
        for term, asked in zip(top.plan["trigger"]["args"], top.values):
            known = OPEN
            if term != "any":
                known = top.theta.get(term["var"], OPEN) if "var" in term else evaluate(term["expr"], top.theta)
            values.append(asked if known is OPEN else known)
        theta = match(query["args"], values, below.theta)
        if theta is None:
            raise Failed
        if any(t != "any" and "var" in t and t["var"] not in theta for t in query["args"]):
            theta = self.oldest(query, theta)[1]
        below.theta = theta

    def oldest(self, what, theta):
        well_bound(what["args"], theta)
        for fact in self.B[what["belief"]]:
            found = match(what["args"], fact, theta)
            if found is not None:
                return fact, found
        raise Failed

    def fail(self, i):
        while i.frames:
            top = i.frames.pop()
            on = top.plan["trigger"]["on"]
            frame = self.select({"goal_failed": on["goal_added"]}, top.values) if "goal_added" in on else None
            if frame:
                i.frames.append(frame)
                self.resume(i)
                return

    def step(self, i):
        top = i.frames[-1]
        ((form, of),) = top.plan["body"][top.next]["kind"].items()
        top.next += 1
        try:
            self.do(i, top, form, of)
        except (Fault, Failed):
            self.fail(i)

    def do(self, i, top, form, of):
        values = lambda: [evaluate(e, top.theta) for e in of["args"]]
        declared = lambda: typed(self.it["beliefs"][of["belief"]]["params"], values())
        if form == "do":
            self.given.append((i, of["event"], typed(self.program["events"][of["event"]]["params"], values())))
            return
        if form == "achieve":
            self.post({"goal_added": of["goal"]}, values(), i)
            return
        if form == "await":
            within = of["within"]
            self.A.append((i, of["events"], None if within is None else self.set_timer(i, within)))
            return
        if form == "wait":
            seconds = evaluate(of["seconds"], top.theta)
            if not 0 <= seconds < float("inf"):
                raise Failed
            self.set_timer(i, round(seconds * UNIT))
            return
        if form == "query":
            try:
                top.theta = self.oldest(of, top.theta)[1]
            except Failed:
                if not self.relevant({"test_added": of["belief"]}):
                    raise
                self.post({"test_added": of["belief"]}, [self.asked(t, top.theta) for t in of["args"]], i)
                return
        elif form == "spawn":
            self.post({"goal_added": of["goal"]}, values(), None)
        elif form == "add":
            self.add(of["belief"], declared())
        elif form == "remove":
            try:
                fact, _ = self.oldest(of, top.theta)
                self.B[of["belief"]].remove(fact)
                self.announce({"belief_removed": of["belief"]}, fact)
            except Failed:
                pass
        elif form == "replace":
            fact, facts = declared(), self.B[of["belief"]]
            others = [f for f in facts if f != fact]
            new = fact not in facts
            self.B[of["belief"]] = [fact]
            for other in others:
                self.announce({"belief_removed": of["belief"]}, other)
            if new:
                self.announce({"belief_added": of["belief"]}, fact)
        self.resume(i)

    def asked(self, term, theta):
        if term == "any":
            return OPEN
        try:
            return theta.get(term["var"], OPEN) if "var" in term else evaluate(term["expr"], theta)
        except Fault:
            return OPEN

    def add(self, belief, fact):
        if fact not in self.B[belief]:
            self.B[belief].append(fact)
            self.announce({"belief_added": belief}, fact)

    # ── in a run ──

    def due(self):
        times = [w[0] for w in self.W] + [s.until for s in self.stimuli]
        return min(times, default=None)

    def wake(self, now, expire, happen):
        self.now = now
        over = []
        for stimulus in list(self.stimuli):
            stimulus.go_on(now, happen)
            if stimulus.is_over(now):
                self.stimuli.remove(stimulus)
                over.append(stimulus.i)
        for i in over:
            self.resume(i)
        self.round(expire, happen)

    def hear(self, now, expire, event, args, happen):
        self.now = now
        self.N.append((event, args))
        self.round(expire, happen)

    def round(self, expire, happen):
        while True:
            self.settle()
            while expire and any(w[0] <= self.now for w in self.W):
                self.expire()
                self.settle()
            if not self.given:
                return
            given, self.given = self.given, []
            for i, event, args in given:
                stimulus = Stimulus(self.program, i, event, args, self.now, happen)
                if stimulus.is_over(self.now):
                    self.resume(i)
                else:
                    self.stimuli.append(stimulus)


class Stimulus:
    """A stimulus under way; an event is one without steps."""

    def __init__(self, program, i, event, args, now, happen):
        self.i, self.until = i, now
        happen(event, args)
        body = program["events"][event]["stimulus"]
        self.steps = list(self.taken(body["steps"], dict(enumerate(args)))) if body else []
        self.go_on(now, happen)

    def taken(self, steps, names):
        for step in steps:
            ((form, of),) = step.items()
            if form == "if":
                yield from self.taken(of["then" if evaluate(of["condition"], names) else "otherwise"], names)
            elif form == "emit":
                yield form, (of["event"], [evaluate(a, names) for a in of["args"]])
            elif form == "hold":
                yield form, round(max(0, evaluate(of["seconds"], names)) * UNIT)

    def go_on(self, now, happen):
        while self.until <= now and self.steps:
            form, of = self.steps.pop(0)
            if form == "emit":
                happen(*of)
            else:
                self.until = now + of

    def is_over(self, now):
        return not self.steps and self.until <= now


def run(program, players, limit):
    """The harness, without a world."""
    events, actors = program["events"], program["actors"]
    now, queue, trace = 0, [], []

    def perceives(actor, event):
        e = events[event]
        if e["stimulus"]:
            return actors[actor]["role"] == "environment"
        return not e["to"] or actor in e["to"] or actor == e["from"]

    def maker(player):
        def happen(event, args):
            trace.append((now, events[event]["name"], args))
            queue.append((player, event, args))
        return happen

    def deliver(expire):
        while queue:
            of, event, args = queue.pop(0)
            for player in players:
                if player is not of and perceives(player.actor, event):
                    player.hear(now, expire, event, args, maker(player))

    players.sort(key=lambda p: actors[p.actor]["role"] != "system")
    for player in players:
        player.wake(now, False, maker(player))
    deliver(False)
    while True:
        times = [p.due() for p in players if p.due() is not None]
        if not times or min(times) > limit:
            return trace
        now = max(now, min(times))
        for expire in (False, True):
            for player in players:
                if player.due() is not None and player.due() <= now:
                    player.wake(now, expire, maker(player))
                    deliver(expire)


if __name__ == "__main__":
    given = json.load(sys.stdin)
    for cast in given["runs"]:
        players = [Agent(given["program"], one["agent"], one["chosen"]) for one in cast]
        for time, name, values in run(given["program"], players, given["limit"]):
            print(time, name, *(str(v).lower() if isinstance(v, bool) else v for v in values))
        print(".")
