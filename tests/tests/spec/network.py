"""Which goals of a network can be reached, by the rules of `spec/automata.md`: every state is made, and time goes in ticks that are
fine enough for the constants and the number of clocks. No zones, no extrapolation.
"""

import json
import sys
from itertools import product

from agent_values import evaluate
from events import fits

TICK = 250_000_000

given = json.load(sys.stdin)
program = given["program"]
network = [program["automata"][a] for a in program["networks"][0]["automata"]]
slots = [("shared", v) for v in program["shared"]] + [(i, v) for i, a in enumerate(network) for v in a["vars"]]
clocks = [(i, c) for i, a in enumerate(network) for c in range(len(a["clocks"]))]
points, limits = program["coverage"]["points"], program["assumptions"]
caps = [max(max(b["lo"], -1 if b["hi"] is None else b["hi"] + 1) for b in p["bins"]) for p in points]
bounds = [c["bound"] for a in network for l in a["locations"] for c in l["invariant"]]
bounds += [c["bound"] for a in network for e in a["edges"] for c in e["clock_guard"]]
assert all(b % (4 * TICK) == 0 for b in bounds) and len(clocks) < 4
LAST = max(bounds) // TICK + 1  # a clock that is above all constants stays there

COMPARE = {
    "lt": lambda a, b: a < b, "le": lambda a, b: a <= b, "eq": lambda a, b: a == b, "ge": lambda a, b: a >= b,
    "gt": lambda a, b: a > b,
}


def value(var, n):
    return bool(n) if var["is_bool"] else n


def holds(i, constraints, u):
    return all(COMPARE[c["op"]](u[clocks.index((i, c["clock"]))] * TICK, c["bound"]) for c in constraints)


def invariants(ells, u):
    return all(holds(i, a["locations"][l]["invariant"], u) for i, (a, l) in enumerate(zip(network, ells)))


def kinds(ells):
    return [a["locations"][l]["kind"] for a, l in zip(network, ells)]


def names(i, v, binding):
    """What the expressions of an automaton see: shared variables, its own, the binding."""
    seen = [value(var, n) for (of, var), n in zip(slots, v) if of in ("shared", i)]
    return dict(enumerate(seen + list(binding)))


def bindings(edge, bound=()):
    domains = [[value(s, n) for n in range(s["lo"], s["hi"] + 1)] for s in edge["selects"]]
    return [chosen + tuple(bound) for chosen in product(*domains)]


def is_open(i, edge, v, binding):
    return edge["guard"] is None or evaluate(edge["guard"], names(i, v, binding))


def receptions(i, ells, v, u, event, args):
    """The edges by which an automaton can take part, with their bindings."""
    for number, edge in enumerate(network[i]["edges"]):
        sync = edge["sync"]
        if edge["from"] != ells[i] or "receive" not in sync or sync["receive"]["event"] != event:
            continue
        patterns = sync["receive"]["args"]
        wanted = ["any" if p == "bind" else p["match"] for p in patterns]
        if not fits([{"event": event, "args": wanted}], event, args) or not holds(i, edge["clock_guard"], u):
            continue
        bound = [a for p, a in zip(patterns, args) if p == "bind"]
        for binding in bindings(edge, bound):
            if is_open(i, edge, v, binding):
                yield i, number, binding


def after(state, moves, event, args):
    """The state after a transition, or None."""
    ells, v, u, counts, limited = state
    if "committed" in kinds(ells) and all(kinds(ells)[i] != "committed" for i, _, _ in moves):
        return None
    ells, v, u, counts, limited = list(ells), list(v), list(u), list(counts), list(limited)
    if event is not None:
        for n, limit in enumerate(limits):
            limited[n] += fits(limit["events"], event, args)
            if limited[n] > limit["at_most"]:
                return None
        for n, point in enumerate(points):
            counts[n] = min(caps[n], counts[n] + fits(point["count"], event, args))
    for i, number, binding in moves:
        edge = network[i]["edges"][number]
        own = [n for n, (of, _) in enumerate(slots) if of in ("shared", i)]
        for update in edge["updates"]:
            if "reset" in update:
                u[clocks.index((i, update["reset"]["clock"]))] = 0
            else:
                at = own[update["assign"]["slot"]]
                v[at] = int(evaluate(update["assign"]["value"], names(i, v, binding)))
                assert slots[at][1]["lo"] <= v[at] <= slots[at][1]["hi"], "a fault of the model"
        ells[i] = edge["to"]
    return (tuple(ells), tuple(v), tuple(u), tuple(counts), tuple(limited)) if invariants(ells, u) else None


def successors(state):
    """Each with the edges taken."""
    ells, v, u, counts, limited = state
    later = tuple(min(LAST, t + 1) for t in u)
    if set(kinds(ells)) == {"normal"} and invariants(ells, later):
        yield (ells, v, later, counts, limited), []
    for i, automaton in enumerate(network):
        for number, edge in enumerate(automaton["edges"]):
            if edge["from"] != ells[i] or "receive" in edge["sync"] or not holds(i, edge["clock_guard"], u):
                continue
            for binding in bindings(edge):
                if not is_open(i, edge, v, binding):
                    continue
                event, args, others = None, [], []
                if edge["sync"] != "internal":
                    event = edge["sync"]["send"]["event"]
                    args = [evaluate(a, names(i, v, binding)) for a in edge["sync"]["send"]["args"]]
                    rest = [j for j in range(len(network)) if j != i]
                    others = [list(receptions(j, ells, v, u, event, args)) for j in rest]
                for taken in product(*filter(None, others)):
                    moves = [(i, number, binding), *taken]
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
        tuple(a["initial"] for a in network), tuple(v["init"] for _, v in slots), (0,) * len(clocks),
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
