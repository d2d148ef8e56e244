"""Which goals of a network can be reached, by the rules of `spec/automata-semantics.md`: every state is made, and time goes in ticks
that are fine enough for the constants and the number of clocks. No zones, no extrapolation.
"""

import json
import sys
from itertools import product

from agent_machine import fits_one
from agent_values import alike, evaluate, value_of
from network_data import Scope, kept, value

TICK = 250_000_000

given = json.load(sys.stdin)
program = given["program"]
for absent in ("clocks", "channels", "functions"):
    program.setdefault(absent, [])


class Network:
    program = program
    automata = program["networks"][0]["automata"]
    members = [program["automata"][a] for a in automata]
    owners = [None] * len(program["shared"]) + [i for i, a in enumerate(members) for _ in a["vars"]]
    variables = program["shared"] + [v for a in members for v in a["vars"]]

    def known(self, member):
        return [n for n, of in enumerate(self.owners) if of is None or of == member]


net = Network()
network, channels = net.members, program["channels"]
clocks = [(None, c) for c in range(len(program["clocks"]))]
clocks += [(i, c) for i, a in enumerate(network) for c in range(len(a["clocks"]))]
points, limits = program["coverage"]["points"], program["assumptions"]
caps = [max(max(b["lo"], -1 if b["hi"] is None else b["hi"] + 1) for b in p["bins"]) for p in points]


def most(time):
    """The greatest that a time with variables becomes; all in it are small."""
    assert time["nanos"] % (4 * TICK) == 0 and all(t["factor"] % (4 * TICK) == 0 for t in time.get("terms", ()))
    return abs(time["nanos"]) + sum(abs(t["factor"]) * 4 for t in time.get("terms", ()))


constraints = [c for a in network for l in a["locations"] for c in l["invariant"]]
constraints += [c for a in network for e in a["edges"] for c in e["clock_guard"]]
assert len(clocks) < 4 and all(c["minus"] is None for c in constraints), "not for differences"
LAST = max(most(c["bound"]) for c in constraints) // TICK + 1  # a clock that is above all constants stays there

COMPARE = {
    "lt": lambda a, b: a < b, "le": lambda a, b: a <= b, "eq": lambda a, b: a == b, "ge": lambda a, b: a >= b,
    "gt": lambda a, b: a > b,
}


def clock(i, c):
    shared = len(program["clocks"])
    return c if c < shared else clocks.index((i, c - shared))


def holds(i, bounds, v, u, binding=()):
    scope = Scope(net, i, list(v), binding)
    return all(COMPARE[c["op"]](u[clock(i, c["clock"])] * TICK, scope.time(c["bound"])) for c in bounds)


def invariants(ells, v, u):
    places = [(i, a["locations"][l]) for i, (a, l) in enumerate(zip(network, ells))]
    parts = [(i, l["holds"]) for i, l in places if l.get("holds")]
    return all(evaluate(part, Scope(net, i, list(v), ())) for i, part in parts) and all(
        holds(i, l["invariant"], v, u) for i, l in places
    )


def kinds(ells):
    return [a["locations"][l]["kind"] for a, l in zip(network, ells)]


def form(edge):
    """What it has part in, and the rest of it."""
    return (edge["sync"], {}) if isinstance(edge["sync"], str) else next(iter(edge["sync"].items()))


def ways(i, ells, v, u, wanted, over=None, args=None):
    """The edges of one form, over one event or channel, that are open, with their bindings. Without u clocks do not matter."""
    for number, edge in enumerate(network[i]["edges"]):
        kind, of = form(edge)
        if edge["from"] != ells[i] or kind != wanted or over not in (None, of.get("event", of.get("channel"))):
            continue
        bound = ()
        if args is not None:
            pairs = list(zip(of["args"], args))
            matched = [(p["match"], a) for p, a in pairs if p != "bind"]
            if not all(p == "any" or alike(value_of(p["is"]), a) for p, a in matched):
                continue
            bound = tuple(a for p, a in pairs if p == "bind")
        for chosen in product(*([value(s, n) for n in range(s["lo"], s["hi"] + 1)] for s in edge["selects"])):
            binding = chosen + bound
            scope = Scope(net, i, list(v), binding)
            if edge["guard"] is not None and not evaluate(edge["guard"], scope):
                continue
            if u is None or holds(i, edge["clock_guard"], v, u, binding):
                yield i, number, binding


def arguments(move, v):
    i, number, binding = move
    _, of = form(network[i]["edges"][number])
    args = [evaluate(a, Scope(net, i, list(v), binding)) for a in of["args"]]
    if "channel" in of:
        for param, a in zip(channels[of["channel"]]["params"], args):
            kept(param, a)
    return args


def broadcasts(move, ells, v, u, wanted, over, args):
    rest = [j for j in range(len(network)) if j != move[0]]
    others = [list(ways(j, ells, v, u, wanted, over, args)) for j in rest]
    return [[move, *taken] for taken in product(*filter(None, others))]


def over_channel(number, ells, v, u):
    """All moves over a channel; without u, those that make it urgent."""
    kind = channels[number]["kind"]
    if isinstance(kind, dict):
        participants = [p for p in kind["multi_way"] if p["automaton"] in net.automata]
        each = [list(ways(net.automata.index(p["automaton"]), ells, v, u, "join", number)) for p in participants]
        if any(not found and not p["optional"] for p, found in zip(participants, each)):
            return []
        return [list(moves) for moves in product(*filter(None, each)) if moves]
    found = []
    for i in range(len(network)):
        for move in list(ways(i, ells, v, u, "offer", number)):
            args = arguments(move, v)
            if kind == "broadcast":
                found += broadcasts(move, ells, v, u, "accept", number, args)
            else:
                others = [j for j in range(len(network)) if j != i]
                found += [[move, m] for j in others for m in ways(j, ells, v, u, "accept", number, args)]
    return found


def patient(ells, v):
    return set(kinds(ells)) == {"normal"} and not any(
        c["urgent"] and over_channel(n, ells, v, None) for n, c in enumerate(channels)
    )


def after(state, moves, event, args):
    """The state after a transition, or None."""
    ells, v, u, counts, limited = state
    if "committed" in kinds(ells) and all(kinds(ells)[i] != "committed" for i, _, _ in moves):
        return None
    ells, v, u, counts, limited = list(ells), list(v), list(u), list(counts), list(limited)
    if event is not None:
        for n, limit in enumerate(limits):
            limited[n] += fits_one(limit["events"], event, args)
            if limited[n] > limit["at_most"]:
                return None
        for n, point in enumerate(points):
            counts[n] = min(caps[n], counts[n] + fits_one(point["count"], event, args))
    for i, number, binding in moves:
        scope = Scope(net, i, v, binding)
        for update in network[i]["edges"][number]["updates"]:
            ((kind, of),) = update.items()
            if kind == "reset":
                old = 0 if of["from"] is None else u[clock(i, of["from"])]
                new = old + scope.time(of["to"]) // TICK
                assert new >= 0, "a fault of the model"
                u[clock(i, of["clock"])] = min(LAST, new)
            elif kind == "assign":
                scope.assign(of["place"], of["value"])
            else:
                scope.apply(of["function"], [evaluate(a, scope) for a in of["args"]])
        ells[i] = network[i]["edges"][number]["to"]
    return (tuple(ells), tuple(v), tuple(u), tuple(counts), tuple(limited)) if invariants(ells, v, u) else None


def successors(state):
    """Each with the edges taken."""
    ells, v, u, counts, limited = state
    places = [(i, a["locations"][l]) for i, (a, l) in enumerate(zip(network, ells))]
    standing = {clock(i, c) for i, l in places for c in l.get("stopped", [])}
    later = tuple(t if x in standing else min(LAST, t + 1) for x, t in enumerate(u))
    if patient(ells, v) and invariants(ells, v, later):
        yield (ells, v, later, counts, limited), []
    groups = [([move], None, []) for i in range(len(network)) for move in ways(i, ells, v, u, "internal")]
    for i in range(len(network)):
        for move in ways(i, ells, v, u, "send"):
            args = arguments(move, v)
            event = form(network[i]["edges"][move[1]])[1]["event"]
            groups += [(g, event, args) for g in broadcasts(move, ells, v, u, "receive", event, args)]
    groups += [(g, None, []) for n in range(len(channels)) for g in over_channel(n, ells, v, u)]
    for moves, event, args in groups:
        new = after(state, moves, event, args)
        if new:
            yield new, moves


def is_in(condition, counts):
    ((form, of),) = condition.items()
    if form == "in":
        b = points[of["point"]]["bins"][of["bin"]]
        n = counts[of["point"]]
        return b["lo"] <= n and (b["hi"] is None or n <= b["hi"])
    if form == "not":
        return not is_in(of, counts)
    return (all if form == "and" else any)(is_in(c, counts) for c in of)


def bins(state):
    if "committed" in kinds(state[0]):
        return
    for cross in program["coverage"]["crosses"]:
        if not any(is_in(c, state[3]) for c in cross["ignore"]):
            yield from (f"bin {cross['name']}.{b['name']}" for b in cross["bins"] if is_in(b["when"], state[3]))


def is_made(location):
    return "~" in location["name"]


def reached():
    start = (
        tuple(a["initial"] for a in network), tuple(v["init"] for v in net.variables), (0,) * len(clocks),
        (0,) * len(points), (0,) * len(limits),
    )
    seen, todo, goals = {start}, [start], set()
    while todo:
        state = todo.pop()
        goals.update(bins(state))
        for a, l in zip(network, state[0]):
            if not is_made(a["locations"][l]):
                goals.add(f"location {a['name']}.{a['locations'][l]['name']}")
        for new, moves in successors(state):
            for i, number, _ in moves:
                edges = network[i]["edges"]
                written = [n for n, e in enumerate(edges) if not is_made(network[i]["locations"][e["from"]])]
                if number in written:
                    goals.add(f"edge {network[i]['name']} {written.index(number) + 1}")
            if new not in seen:
                seen.add(new)
                todo.append(new)
    return goals


print("\n".join(sorted(reached())))
