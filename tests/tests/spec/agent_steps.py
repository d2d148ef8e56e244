"""What is done for each sort of step, as the tables of `spec/agents-semantics.md` say."""

from agent_queries import Query, all_known, form_of, match, match_all, match_annotations, well_bound
from agent_state import Block, Event, Failed, Frame, Group, Message, failed_of
from agent_values import OPEN, Fault, alike, evaluate, plain, typed, written

SELF = ["source", {"expr": {"const": "self"}}]


class Steps:
    """What is done for each sort of step; the result says whether the intention goes on at once."""

    def __init__(self, agent, i, frame):
        self.agent, self.i, self.frame = agent, i, frame
        self.called = frame.plan["vars"]

    def value(self, e):
        return evaluate(e, self.frame.theta, self.called)

    def values(self, args):
        return [self.value(e) for e in args]

    def typed(self, params, values):
        fitting = values if params is None else typed(params, values)
        if fitting is None:
            raise Failed("a value is not of its type")
        return fitting

    def first(self, formula):
        return next(Query(self.agent, self.called).answers(formula, self.frame.theta), None)

    def bind(self, theta):
        if theta is None:
            raise Failed("no answer")
        self.frame.theta = theta
        return True

    # ── Actions and goals ──

    def do(self, of):
        values = self.typed(self.agent.program["events"][of["event"]]["params"], self.values(of["args"]))
        self.i.doing = (of["event"], len(self.agent.given))
        self.agent.given.append((self.i, self.i.doing, of["event"], values))

    def wanted(self, e):
        """The value of an argument of a goal that is waited for: a variable may be open."""
        return self.frame.theta.get(e["var"], OPEN) if isinstance(e, dict) and "var" in e else self.value(e)

    def goal(self, of, value):
        params = self.agent.it["goals"][of["goal"]]["params"]
        values = self.typed(params, [value(e) for e in of["args"]])
        return {"goal_added": of["goal"]}, values, [("source", "self")]

    def achieve(self, of):
        goal = self.goal(of, self.wanted)
        timer = self.timer(of, "deadline")
        self.agent.post(Event(*goal, self.i, None, timer))

    def spawn(self, of):
        self.agent.post(Event(*self.goal(of, self.value)))
        return True

    def query(self, of):
        theta = self.first({"belief": of})
        on = {"test_added": of["belief"]}
        plans = self.agent.relevant(on) or self.agent.relevant(failed_of(on))
        if theta is not None or of["annotations"] or not plans:
            return self.bind(theta)
        self.agent.post(Event(on, all_known(of["args"], self.frame.theta), [], self.i))

    def test(self, of):
        return self.bind(self.first(of))

    def fail(self, _):
        raise Failed(".fail")

    # ── Beliefs ──

    def fact(self, of):
        params = self.agent.it["beliefs"][of["belief"]]
        values = self.typed(params["params"], self.values(of["args"]))
        annotations = []
        for name, e in of["annotations"]:
            value = self.value(e)
            if name != "source":
                (value,) = self.typed([params["annotations"][name["declared"]]], [value])
            annotations.append((name, value))
        return of["belief"], values, annotations

    def add(self, of):
        self.agent.add(*self.fact(of))
        return True

    def replace(self, of):
        belief, values, annotations = self.fact(of)
        for fact in list(self.agent.beliefs[belief]):
            if not all(map(alike, fact.values, values)):
                self.agent.leave(belief, fact)
        self.agent.add(belief, values, annotations)
        return True

    def matching(self, of, fact, annotations):
        """Each θ under which a fact matches a literal with these annotations."""
        found = match_all(of["args"], fact.values, self.frame.theta, self.called)
        return () if found is None else match_annotations(annotations, fact.annotations, found, self.called)

    def remove(self, of):
        source = next((a for a in of["annotations"] if a[0] == "source"), SELF)
        others = [a for a in of["annotations"] if a is not source]
        plain_ones = [a for a in of["annotations"] if a[0] != "source"]
        well_bound(of["args"] + [term for _, term in [source] + others], self.frame.theta, self.called)

        def sources(fact):
            """Those of the fact's that the term means, each with what is known then."""
            for theta in self.matching(of, fact, []):
                for one in fact.sources():
                    found = match(source[1], one, theta, self.called)
                    rest = found is not None and match_annotations(others, fact.annotations, found, self.called)
                    found = next(rest, None) if rest else None
                    if found is not None:
                        yield one, found

        admits = lambda fact: next(iter(self.matching(of, fact, plain_ones)), None) is not None
        meant = written(all_known([source[1]], self.frame.theta)[0])
        theta = self.agent.remove(of["belief"], admits, sources, meant)
        return True if theta is None else self.bind(theta)

    def abolish(self, of):
        well_bound(of["args"] + [term for _, term in of["annotations"]], self.frame.theta, self.called)
        for fact in list(self.agent.beliefs[of["belief"]]):
            if next(iter(self.matching(of, fact, of["annotations"])), None) is not None:
                self.agent.leave(of["belief"], fact)
        return True

    # ── Time ──

    def timer(self, of, sort):
        return self.agent.set_timer(self.i, self.value(of["within"]), sort) if of["within"] else None

    def wait(self, of):
        self.agent.set_timer(self.i, self.value(of["seconds"]), "wait")

    # `await` is a word of Python's.
    def await_(self, of):
        timer = self.timer(of, "await")
        self.agent.awaiting.append((self.i, of["events"], timer))

    # ── Blocks ──

    def decided(self, form, formula):
        """The first answer; the log has whether there is one."""
        try:
            theta = self.first(formula)
        except Fault:
            self.agent.log(form, self.i)
            raise
        self.agent.log(f"{form} {'false' if theta is None else 'true'}", self.i)
        return theta

    def if_(self, of):
        theta = self.decided("if", of["condition"])
        if theta is not None:
            self.frame.theta = theta
        self.frame.blocks.append(Block(of["otherwise" if theta is None else "then"]))
        return True

    def while_(self, of):
        theta = self.decided("while", of["condition"])
        if theta is not None:
            self.frame.blocks.append(Block(of["body"], "while", self.frame.theta))
            self.frame.theta = theta
        return True

    def for_(self, of):
        try:
            found = list(Query(self.agent, self.called).answers(of["condition"], self.frame.theta))
        except Fault:
            self.agent.log("for", self.i)
            raise
        self.agent.log(f"for: {len(found)} answer{'s' * (len(found) != 1)}", self.i)
        if found:
            self.frame.blocks.append(Block(of["body"], "for", self.frame.theta, found[1:]))
            self.frame.theta = found[0]
        return True

    def fork(self, of):
        group = Group(self.i, of["all"])
        event = Event(self.frame.on, self.frame.values, self.frame.annotations)
        for steps in of["branches"]:
            branch, _ = self.agent.adopt(event)
            branch.group = group
            branch.frames.append(Frame(self.frame.plan, event, self.frame.theta, steps))
            group.members.append(branch)
        self.i.fork = group
        branches = list(group.members)
        # At the front, too, the first branch is the first.
        for branch in reversed(branches) if self.i.is_atomic() else branches:
            if branch.alive:
                self.agent.resume(branch)

    # ── Messages ──

    def receiver(self, to, content, sort):
        """The agent, and what the content is to it."""
        name = self.value(to)
        company = self.agent.company
        other = self.agent if name == "self" else next((a for a in company.agents if a.name == name), None)
        if not other:
            raise Failed(f"{name} is not in this run")
        return other, self.subject(other, content, sort)

    def subject(self, other, content, sort):
        subject = self.agent.program["contents"][content]["of"][other.number]
        if not subject or sort not in subject:
            raise Failed(f"{other.name} has nothing of this name")
        return subject[sort]

    def declared(self, other, sort, number):
        return other.it["goals" if sort == "goal" else "beliefs"][number]["params"]

    def send(self, of):
        content, performative = of["content"], of["performative"]
        sort = "goal" if performative in ("achieve", "unachieve") else "belief"
        if of["to"]:
            others = [self.receiver(of["to"], content, sort)]
        else:
            subjects = self.agent.program["contents"][content]["of"]
            others = [a for a in self.agent.company.agents if sort in (subjects[a.number] or ())]
            others = [(a, subjects[a.number][sort]) for a in others if a is not self.agent]
        if performative in ("ask_one", "ask_all"):
            self.subject(self.agent, content, sort)
        values = self.content_values(of, performative in ("tell", "achieve"))
        marks = [(name, self.value(e)) for name, e in of.get("annotations", [])]
        messages = []
        for other, number in others:
            fitting = values
            if performative in ("tell", "achieve"):
                fitting = self.typed(self.declared(other, sort, number), values)
            told = []
            for name, value in marks:
                declared = other.it["beliefs"][number]["annotations"]
                at = next(i for i, p in enumerate(declared) if p["name"] == name)
                told.append(({"declared": at}, self.typed([declared[at]], [value])[0]))
            messages.append((other, Message(self.agent, performative, content, fitting, None, told)))
        self.agent.outbox += messages
        return True

    def content_values(self, of, closed):
        well_bound(of["args"], self.frame.theta, self.called)
        return [self.closed(t) for t in of["args"]] if closed else all_known(of["args"], self.frame.theta)

    def closed(self, term):
        """The value of a term that must have one."""
        form, of = form_of(term)
        if form == "any":
            raise Fault("`_` has no value")
        if form != "list":
            return self.value(term if form == "var" else of)
        rest = self.closed(of[1]) if of[1] else ()
        return tuple(self.closed(part) for part in of[0]) + rest

    def asking(self, of, what):
        other, _ = self.receiver(of["to"], of["content"], "belief")
        values = self.content_values(of, False)
        timer = self.timer(of, "ask")
        request = self.agent.company.request()
        self.agent.requests[request] = (self.i, of, timer)
        self.agent.outbox.append((other, Message(self.agent, what, of["content"], values, request)))

    def ask(self, of):
        self.asking(of, "ask")

    def ask_all(self, of):
        self.asking(of, "ask all")

    def print(self, of):
        self.agent.log("prints " + "".join(plain(v) for v in self.values(of["args"])))
        return True

    # ── Goals ──

    def control(self, of):
        agent, what = self.agent, of["what"]
        if of["goal"] is None:
            self.control_all(what)
            return True
        goal, args = of["goal"]
        well_bound(args, self.frame.theta, self.called)
        theta, called = self.frame.theta, self.called
        admits = lambda values: match_all(args, values, theta, called) is not None
        if what in ("succeed_goal", "fail_goal"):
            agent.end_goal(goal, admits, what == "succeed_goal")
            return True
        {
            "drop_intention": agent.drop_intentions,
            "drop_desire": agent.drop_desires,
            "drop_event": agent.drop_events,
            "suspend": agent.suspend,
            "resume": agent.go_on,
        }[what](goal, admits)
        return True

    def control_all(self, what):
        if what == "suspend":
            self.i.suspended = True
        if what in ("drop_event", "drop_desire"):
            for event in list(self.agent.events):
                if what == "drop_event" or "goal_added" in event.on:
                    self.agent.drop_event(event)
        if what in ("drop_intention", "drop_desire"):
            self.agent.drop_others(self.i)


for word in ("await", "if", "while", "for"):
    setattr(Steps, word, getattr(Steps, word + "_"))
