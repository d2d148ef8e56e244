"""Variables, arrays and functions of automata, as `spec/automata.md` defines them."""

from agent_values import Fault, evaluate, resolved

STATEMENTS, DEPTH = 1_000_000, 100


def value(var, n):
    return bool(n) if var["is_bool"] else n


def kept(var, v):
    """The number that a variable keeps for a value."""
    if not var["lo"] <= int(v) <= var["hi"]:
        raise Fault(f"`{var['name']}` becomes {v}")
    return int(v)


class Scope:
    """What the expressions of an automaton see: shared variables, its own, then binders or a function's parameters and locals.

    `v` are the numbers of all variables, and are changed by assignments; `known` tells which of them it sees, in order.
    """

    def __init__(self, network, member, v, rest, types=None, depth=0, count=None):
        self.network, self.member, self.v, self.rest, self.types = network, member, v, list(rest), types
        self.known = network.known(member)
        self.depth, self.count = depth, count

    def __contains__(self, slot):
        return slot < len(self.known) + len(self.rest)

    def __getitem__(self, slot):
        if slot < len(self.known):
            at = self.known[slot]
            return value(self.network.variables[at], self.v[at])
        slot -= len(self.known)
        return self.rest[slot] if self.types is None else value(self.types[slot], self.rest[slot])

    def assign(self, place, expression):
        slot = resolved(place, self)
        got = evaluate(expression, self)
        self.store(slot, got)

    def store(self, slot, got):
        if slot < len(self.known):
            at = self.known[slot]
            self.v[at] = kept(self.network.variables[at], got)
        else:
            slot -= len(self.known)
            self.rest[slot] = kept(self.types[slot], got)

    def apply(self, number, values):
        function = self.network.program["functions"][number]
        if self.depth >= DEPTH:
            raise Fault("calls too deep")
        types = function["params"] + function["locals"]
        rest = [kept(p, a) for p, a in zip(function["params"], values)] + [x["init"] for x in function["locals"]]
        member = None if function["owner"] is None else self.network.automata.index(function["owner"])
        count = [0] if self.count is None else self.count
        inside = Scope(self.network, member, self.v, rest, types, self.depth + 1, count)
        done, got = inside.run(function["body"])
        if done and function["result"] is not None:
            kept(function["result"], got)
        return got

    def step(self):
        self.count[0] += 1
        if self.count[0] > STATEMENTS:
            raise Fault("a function does not end")

    def run(self, body):
        """Whether it returned, and what."""
        for statement in body:
            self.step()
            done = self.one(statement)
            if done:
                return done
        return None, None

    def one(self, statement):
        ((form, of),) = statement.items()
        if form == "assign":
            self.assign(of["place"], of["value"])
        elif form == "call":
            self.apply(of["function"], [evaluate(a, self) for a in of["args"]])
        elif form == "if":
            return self.ended(of["then"] if evaluate(of["condition"], self) else of["otherwise"])
        elif form == "while":
            while evaluate(of["condition"], self):
                self.step()
                if done := self.ended(of["body"]):
                    return done
        elif form == "for":
            low, high = evaluate(of["lo"], self), evaluate(of["hi"], self)
            for n in range(low, high + 1):
                self.step()
                self.store(of["slot"], n)
                if done := self.ended(of["body"]):
                    return done
        else:
            return True, None if of is None else evaluate(of, self)
        return None

    def ended(self, body):
        done = self.run(body)
        return done if done[0] else None

    def time(self, of):
        """In nanoseconds."""
        return of["nanos"] + sum(t["factor"] * evaluate(t["value"], self) for t in of.get("terms", ()))
