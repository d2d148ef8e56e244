"""Monitors as `spec/monitors.md` defines them, step by step; as slow as it is plain."""

import json
import math
import sys

from agent_machine import fits_one
from agent_values import Fault, evaluate

NEVER = math.inf
COMPARISONS = ("eq", "ne", "lt", "le", "gt", "ge")


def measured(e, names):
    """The truth of a condition, and whether it rests on a comparison of what has no value; None: a signal has no sample."""
    ((form, of),) = e.items()
    if form == "unary" and of[0] == "not":
        known = measured(of[1], names)
        return known and (not known[0], known[1])
    if form == "binary" and of[0] in ("and", "or"):
        settles = of[0] == "or"
        parts = []
        for part in of[1:]:
            known = measured(part, names)
            if known is None or known == (settles, False):
                return known
            parts.append(known)
        (a, first), (b, second) = parts
        return (a or b if settles else a and b), first or second
    if form == "binary" and of[0] in COMPARISONS:
        sides = [side(of[1], names), side(of[2], names)]
        if NEVER in sides:
            return None
        if None in sides:
            return of[0] == "ne", True
    try:
        return evaluate(e, names), False
    except Fault:
        return None


def side(e, names):
    """None: it has no value; NEVER: it reads a signal without a sample."""
    if any(n not in names for n in read(e)):
        return NEVER
    try:
        value = evaluate(e, names)
    except Fault:
        return None
    return None if isinstance(value, float) and math.isnan(value) else 0


def read(e):
    if isinstance(e, dict):
        return [e["var"]] if "var" in e else [n for part in e.values() for n in read(part)]
    return [n for part in e for n in read(part)] if isinstance(e, list) else []


class Monitor:
    def __init__(self, given, number):
        self.it, self.number = given, number
        self.q, self.z, self.f = given["initial"], 0, 0
        self.o = self.s = self.V = self.w = self.margin = None
        self.n = self.k = self.g = 0
        self.unvalued = None
        self.truths = [None for _ in given.get("conditions", [])]
        if "trigger" in given.get("at_start", []):
            self.n, self.o = 1, (0, None)
        self.sigma, self.burst = {}, (None, 0)
        self.d = self.deadline(0)
        self.triggers = any("trigger" in e["effects"] for e in given["edges"])

    def deadline(self, t):
        bound = self.it["states"][self.q]["deadline"]
        return NEVER if bound is None else max(t, self.z + bound)

    def names(self):
        return {i: self.sigma[s][0] for i, s in enumerate(self.it["signals"]) if s in self.sigma}

    def truth(self, e):
        known = measured(e, self.names())
        return known and known[0]

    def value(self, e):
        try:
            return evaluate(e, self.names())
        except Fault:
            return None

    def react(self, cause, t, i):
        for e in self.it["edges"]:
            fits = self.clock_allows(e.get("clock"), t)
            if e["from"] == self.q and cause(e["on"]) and fits and (e["guard"] is None or self.truth(e["guard"]) is True):
                break
        else:
            return
        outside = not self.measures_here()
        moves, effects = e["to"] != self.q, e["effects"]
        for effect in effects:
            if effect == "reset_clock":
                self.z = t
            elif effect == "trigger":
                self.n += 1
                stays = not moves and "reset_clock" not in effects and "fail" not in effects
                if not (stays and self.o):
                    self.o = (t, i)
            elif effect == "discharge":
                self.k, self.o = self.k + 1, None
            elif effect == "suspect":
                self.w = self.violation(t, i)
            elif effect == "fail":
                self.g += 1
                if self.w and not self.V and i is not None and i not in self.w["counterexample"]:
                    self.w["counterexample"].append(i)
                self.V, self.w = self.V or self.w or self.violation(t, i), None
        if moves:
            self.q, self.f = e["to"], t
            self.o = None if "fail" in effects else self.o
        if moves or "reset_clock" in effects:
            self.d = self.deadline(t)
        if outside and self.measures_samples() and self.measures_here():
            self.take_margin(t)

    def clock_allows(self, guard, t):
        if guard is None:
            return True
        (kind, bound), = guard.items()
        return t - self.z < bound if kind == "before" else t - self.z > bound

    def measures_samples(self):
        return self.it["margin"] is not None and not self.it["margin"]["at"]

    def measures_here(self):
        within = (self.it["margin"] or {}).get("within", [])
        return self.it["margin"] is not None and (not within or self.q in within)

    def violation(self, t, i):
        o, read = self.o or (t, i), [s for s in self.it["signals"] if s in self.sigma]
        steps = [o[1], i, *(self.sigma[s][1] for s in read)]
        counterexample = list(dict.fromkeys(step for step in steps if step is not None))
        values = [[s, self.sigma[s][0]] for s in read]
        return {"time": t, "step": i, "trigger_time": o[0], "counterexample": counterexample, "values": values}

    def pass_time(self, t):
        while self.d < t:
            due, self.d = self.d, NEVER
            self.burst = (due, self.burst[1] + 1 if self.burst[0] == due else 1)
            if self.burst[1] <= len(self.it["states"]):
                self.react(lambda on: on == "deadline", due, None)

    def take_margin(self, t):
        m = self.value(self.it["margin"]["value"])
        if m is not None and math.isfinite(m) and (self.margin is None or m < self.margin[0]):
            self.margin = (m, t)

    def sampled(self):
        if self.s:
            (t, i), self.s = self.s, None
            for number, condition in enumerate(self.it.get("conditions", [])):
                self.look(number, condition, t, i)
            self.note_unvalued(t, self.it.get("conditions", []), lambda on: not (isinstance(on, dict) and "event" in on))
            if self.measures_samples() and self.measures_here():
                self.take_margin(t)
            watches = any(e["on"] == "sample" for e in self.it["edges"]) and not self.triggers
            if watches and self.n == 0 and all(s in self.sigma for s in self.it["signals"]):
                self.n, self.o = 1, (t, i)
            self.react(lambda on: on == "sample", t, i)

    def note_unvalued(self, t, conditions, asks):
        guards = [e["guard"] for e in self.it["edges"] if e["guard"] is not None and asks(e["on"])]
        asked = [measured(c, self.names()) for c in [*conditions, *guards]]
        if self.unvalued is None and any(known and known[1] for known in asked):
            self.unvalued = t

    def look(self, number, condition, t, i):
        now, before = self.truth(condition), self.truths[number]
        if now in (True, False) and now != before:
            self.truths[number] = now
            fits = lambda c: c["condition"] == number and c["truth"] == now and (before is not None or c["first"])
            self.react(lambda on: isinstance(on, dict) and "becomes" in on and fits(on["becomes"]), t, i)

    def step(self, i, t, before, what, value):
        if t > before:
            self.sampled()
        self.pass_time(t)
        if isinstance(what, dict):
            if what["signal"] in self.it["signals"]:
                self.sigma[what["signal"]] = (value, i)
                self.s = (t, i)
            return
        is_event = lambda on: isinstance(on, dict) and "event" in on
        is_it = lambda on: is_event(on) and fits_one(on["event"], what, value)
        at = self.it["margin"]["at"] if self.it["margin"] else []
        named = lambda patterns: any(p["event"] == what for p in patterns)
        if named(at) or any(is_event(e["on"]) and named(e["on"]["event"]) for e in self.it["edges"]):
            self.sampled()
        self.note_unvalued(t, [], is_it)
        inside = self.measures_here()
        self.react(is_it, t, i)
        if fits_one(at, what, value) and inside and self.measures_here():
            self.take_margin(t)

    def verdict(self, end):
        self.sampled()
        self.pass_time(end + 1)
        pending = self.it["states"][self.q]["pending"]
        outcome = "fail" if self.g else "inconclusive" if pending else "pass" if self.n else "vacuous"
        if outcome in ("pass", "vacuous") and self.unvalued is not None:
            outcome = "inconclusive"
        return {
            "monitor": self.number, "outcome": outcome, "triggered": self.n, "discharged": self.k, "failures": self.g,
            "first_failure": self.V, "worst_margin": self.margin and list(self.margin),
            "pending_since": (self.o[0] if self.o else self.f) if pending else None,
            "unvalued": self.unvalued,
        }


given = json.load(sys.stdin)
for trace in given["traces"]:
    monitors = [Monitor(m, i) for i, m in enumerate(given["monitors"])]
    before = 0
    for i, (t, what, value) in enumerate(trace["steps"]):
        for monitor in monitors:
            monitor.step(i, t, before, what, value)
        before = t
    print(json.dumps([m.verdict(trace["end"]) for m in monitors]))
