"""The machine of `spec/agents-semantics.md`: one agent, rule by rule, and slowly."""

import math

from agent_queries import OPEN, Query, all_known, form_of, match, match_all, match_annotations, variables, well_bound
from agent_state import Event, Fact, Failed, Frame, Intention, Message, Timer, failed_of
from agent_steps import Steps
from agent_text import PERFORMATIVES, Writer
from agent_values import Fault, alike, applied, contained, evaluate, fits, kind, typed, value_of, values_of, written

FRAMES = 10_000_000
FIRST_STATE = 1024


class Agent:
    def __init__(self, company, program, number):
        self.company, self.program, self.number = company, program, number
        self.it = program["agents"][number]
        self.name, self.actor = self.it["name"], self.it["actor"]
        self.writer = Writer(program, self.it)
        self.beliefs = {b: [] for b in range(len(self.it["beliefs"]))}
        self.events, self.ready, self.inbox, self.timers, self.awaiting = [], [], [], [], []
        self.intentions, self.requests, self.stimuli = [], {}, []
        self.given, self.outbox = [], []
        self.serial = self.adopted = self.cycles = 0
        self.ended = None
        self.named = named_goals(program, number)

    def start(self, chosen):
        for fact in self.it["initial_beliefs"] + chosen:
            self.add(fact["belief"], values_of(fact["args"]), [(a, value_of(v)) for a, v in fact["annotations"]])
        for goal, values in self.it["initial_goals"]:
            self.post(Event({"goal_added": goal}, values_of(values), [("source", "self")]))

    def log(self, text, i=None):
        self.company.log(self.name, text if i is None else f"#{i.number} {text}")

    # ── Events and plans ──

    def relevant(self, on):
        return [p for p in self.it["plans"] if p["trigger"]["on"] == on]

    def post(self, event):
        self.events.insert(0 if event.i and event.i.is_atomic() else len(self.events), event)

    def announce(self, on, values, annotations=()):
        if self.relevant(on):
            self.post(Event(on, values, list(annotations)))

    def select(self, event):
        """The frame of the first applicable plan, or None."""
        for plan in self.relevant(event.on):
            try:
                for theta in applicable(self, plan, event):
                    return Frame(plan, event, theta)
            except Fault as fault:
                self.log(f"fault in the context of {plan['label']}: {fault}")
        return None

    def adopt(self, event):
        """The intention that waits for the event, or a new one; and how the log ends."""
        if event.i:
            return event.i, ""
        self.adopted += 1
        i = Intention(self.adopted)
        i.question = event.question
        self.intentions.append(i)
        return i, f" as #{i.number}"

    def push(self, event, frame):
        i, new = self.adopt(event)
        text = f"{self.writer.event(event.on, event.values)} → {self.writer.selected(frame.plan, frame.theta)}{new}"
        self.log(text, None if new else i)
        early = i.frames and frame.kind().startswith("goal") and not frame.wants()
        if early and self.leaves_early(i.frames[-1]):
            i.frames.pop()
        i.frames.append(frame)
        if len(i.frames) > FRAMES:
            self.fail(i, "the stack is full")
        else:
            self.resume(i)

    def leaves_early(self, frame):
        """Whether it makes no difference that a finished frame leaves before the one that comes above it."""
        sort, number = next(iter(frame.on.items()))
        if frame.is_branch or frame.timer or frame.plan["atomic"] or not frame.is_finished() or sort.startswith("test"):
            return False
        if sort.startswith("goal") and number in self.named or frame.wants():
            return False
        return sort != "goal_added" or not self.relevant({"goal_failed": number})

    def deliberate(self, event):
        frame = self.select(event)
        if frame:
            frame.timer = event.timer
            if event.timer:
                event.timer.frame = frame
            self.push(event, frame)
            return
        self.log(f"{self.writer.event(event.on, event.values)}: no plan is applicable", event.i)
        self.fails_by_itself(event)

    def fails_by_itself(self, event):
        """A goal or a test goal without a plan."""
        self.stop_timer(event.timer)
        failed = failed_of(event.on)
        if not failed:
            return
        event = Event(failed, event.values, event.annotations, event.i, event.question)
        frame = self.select(event)
        if frame:
            self.push(event, frame)
        elif event.i:
            self.unwind(event.i)
        elif event.question:
            self.reply(event.question, None)

    # ── The cycle ──

    def settle(self):
        if self.ended:
            return
        done, remembered, until = 0, None, 0
        while True:
            if not self.events and not self.ready:
                if not self.inbox:
                    return
                self.take_in(self.inbox.pop(0))
                continue
            done, self.cycles = done + 1, self.cycles + 1
            if self.cycles > self.company.cycles:
                return self.end("cycle bound")
            if self.events:
                self.deliberate(self.events.pop(0))
            if self.ready:
                self.step(self.ready.pop(0))
            if done >= FIRST_STATE:
                if remembered and done <= until and self.state() == remembered:
                    return self.end("livelock")
                if done & (done - 1) == 0:
                    remembered, until = self.state(), done + done // 16

    def end(self, how):
        self.ended = how
        self.log(how)

    def state(self):
        """All that what comes depends on; intentions by their rank, not their number."""
        rank = {i: n for n, i in enumerate(self.intentions)} | {None: None}
        block = lambda b: (id(b.steps), b.place, b.saved, b.left)
        frame = lambda f: (id(f.plan), f.on, f.values, f.annotations, f.theta, [block(b) for b in f.blocks])
        intentions = [
            ([frame(f) for f in i.frames], i.suspended, i.held, i.fork and [rank[m] for m in i.fork.members], i.doing)
            for i in self.intentions
        ]
        return repr((
            {b: [(f.values, f.annotations) for f in facts] for b, facts in self.beliefs.items()},
            [(e.on, e.values, e.annotations, rank[e.i]) for e in self.events],
            [rank[i] for i in self.ready],
            intentions,
            [rank[i] for i, _, _ in self.awaiting],
            [(t.due, t.sort, rank[t.i], t.frame and t.i.frames.index(t.frame)) for t in self.ordered_timers()],
            [rank[i] for i, _, _ in self.requests.values()],
            [m if isinstance(m, tuple) else (m.sender.name, m.what, m.content, m.values, m.annotations) for m in self.inbox],
            (len(self.given), len(self.outbox)),
        ))  # fmt: skip

    def ordered_timers(self):
        return sorted(self.timers, key=lambda t: (t.due, t.serial))

    def set_timer(self, i, seconds, sort):
        if kind(seconds) != 1 or not math.isfinite(seconds) or seconds < 0:
            raise Failed("a time is negative, or no number")
        self.serial += 1
        timer = Timer(self.company.now + nanoseconds(seconds), self.serial, i, sort)
        self.timers.append(timer)
        return timer

    def stop_timer(self, timer):
        if timer in self.timers:
            self.timers.remove(timer)

    def expire(self):
        """All timers that are due; what ends one of them may stop another."""
        for timer in [t for t in self.ordered_timers() if t.due <= self.company.now]:
            if timer not in self.timers:
                continue
            self.timers.remove(timer)
            if timer.sort == "wait":
                self.resume(timer.i)
                continue
            if timer.sort == "deadline":
                self.cut(timer.i, timer.i.frames.index(timer.frame) + 1)
            self.stop_waiting(timer.i)
            self.fail(timer.i, "the time is over")

    # ── What comes from outside ──

    def take_in(self, what):
        if isinstance(what, Message):
            self.hear(what)
            return
        event, values = what
        on = {"perceived": event}
        self.log("perceives " + self.writer.event(on, values).removeprefix("on "))
        for belief, declared in enumerate(self.it["beliefs"]):
            if declared["percept"] == event:
                self.perceive(belief, values)
        for waiting in list(self.awaiting):
            i, patterns, timer = waiting
            if waiting in self.awaiting and any(of_pattern(p, event, values) for p in patterns):
                self.awaiting.remove(waiting)
                self.stop_timer(timer)
                self.resume(i)
        self.announce(on, values)

    def perceive(self, belief, values):
        """The latest event's arguments are the only ones with the source `percept`."""
        for fact in list(self.beliefs[belief]):
            if not all(map(alike, fact.values, values)) and "percept" in fact.sources():
                self.take_source(belief, fact, "percept")
        self.add(belief, values, [("source", "percept")])

    def hear(self, m):
        source = "self" if m.sender is self else m.sender.name
        subject = self.program["contents"][m.content]["of"][self.number]
        name = self.program["contents"][m.content]["name"]
        marks = self.annotated(subject["belief"], m.annotations) if m.annotations else ""
        self.log(f"hears {said(m, name)}{marks} from {m.sender.name}")
        if m.what in ("answer", "answers"):
            self.answered(m)
            return
        ((_, number),) = subject.items()
        if m.what == "tell":
            self.add(number, m.values, m.annotations + [("source", source)])
        elif m.what == "untell":
            told = lambda fact: [(source, None)] if source in fact.sources() else []
            self.remove(number, lambda fact: fits(m.values, fact.values), told, source)
        elif m.what == "achieve":
            self.post(Event({"goal_added": number}, m.values, [("source", source)]))
        elif m.what == "unachieve":
            self.drop_desires(number, lambda values: fits(m.values, values))
        else:
            self.question(m, number)

    def question(self, m, belief):
        every = m.what in ("ask_all", "ask all")
        query = Query(self, ())
        try:
            found = query.instances(belief, m.values)
            found = list(found) if every else next(found, None)
        except Fault as fault:
            self.log(f"fault in an answer: {fault}")
            self.reply(m, None)
            return
        on = {"test_added": belief}
        if found is None and (self.relevant(on) or self.relevant(failed_of(on))):
            self.post(Event(on, m.values, [], None, m))
        else:
            self.reply(m, found)

    def reply(self, m, found):
        """Answers a question: tells what was asked for with `.send`; gives it back to `.ask` and `.ask_all`."""
        if m.request is not None:
            what = "answers" if m.what == "ask all" else "answer"
            self.outbox.append((m.sender, Message(self, what, m.content, found, m.request)))
            return
        found = [] if found is None else found if m.what == "ask_all" else [found]
        number = self.program["contents"][m.content]["of"][m.sender.number]["belief"]
        for values in found:
            fitting = typed(m.sender.it["beliefs"][number]["params"], values)
            if fitting is not None:
                self.outbox.append((m.sender, Message(self, "tell", m.content, fitting)))

    def answered(self, m):
        i, of, timer = self.requests.pop(m.request, (None, None, None))
        if not i:
            return
        self.stop_timer(timer)
        frame = i.frames[-1]
        try:
            frame.theta = self.with_answer(of, m.values, frame)
        except (Fault, Failed) as why:
            self.fail(i, str(why))
            return
        self.resume(i)

    def with_answer(self, of, found, frame):
        called = frame.plan["vars"]
        if "template" not in of:
            theta = None if found is None else match_all(of["args"], found, frame.theta, called)
        else:
            each = [match_all(of["args"], values, frame.theta, called) for values in found or []]
            values = tuple(evaluate(of["template"], t, called) for t in each if t is not None)
            theta = None if found is None else match(of["out"], values, frame.theta, called)
        if theta is None:
            raise Failed("no answer")
        return theta

    # ── Intentions ──

    def resume(self, i):
        if i.suspended:
            i.held = True
            return
        while i.frames:
            top = i.frames[-1]
            if top.advance():
                self.ready.insert(0 if i.is_atomic() else len(self.ready), i)
                return
            i.frames.pop()
            self.stop_timer(top.timer)
            if top.kind().startswith("test") or top.wants():
                try:
                    give = self.give_answer if top.kind().startswith("test") else self.give_values
                    give(i, top)
                except (Fault, Failed) as why:
                    self.fail_without(i, top, str(why))
                    return
        self.log("finished", i)
        self.gone(i)
        if i.group:
            self.branch_ended(i, True)

    def fail_without(self, i, top, why):
        """Fails an intention whose top frame has just been taken off."""
        if not i.frames:
            self.log_failure(i, top, why)
            self.unwind(i)
        else:
            self.fail(i, why)

    def give_answer(self, i, top):
        """The terms of the trigger of a finished plan for a query are its answer."""
        belief = next(iter(top.on.values()))
        own = all_known(top.plan["trigger"]["args"], top.theta)
        values = [asked if value is OPEN else value for value, asked in zip(own, top.values)]
        if not i.frames:
            if OPEN in values:
                values = next(Query(self, ()).instances(belief, values), None)
            if values is None:
                raise Failed("no answer")
            self.reply(i.question, values)
            i.question = None
            return
        below = i.frames[-1]
        literal, called = below.at["kind"]["query"], below.plan["vars"]
        theta = match_all(literal["args"], values, below.theta, called)
        if theta is not None and not set(variables(literal)) <= set(theta):
            theta = next(Query(self, called).answers({"belief": literal}, theta), None)
        if theta is None:
            raise Failed("no answer")
        below.theta = theta

    def give_values(self, i, top):
        """The terms of the trigger of a finished plan for a goal are the values of what was open."""
        below = i.frames[-1]
        of = below.at["kind"]["achieve"]
        own = all_known(top.plan["trigger"]["args"], top.theta)
        values = typed_goal(self.it["goals"][of["goal"]]["params"], own, top.values)
        theta = dict(below.theta)
        for asked, value, e in zip(top.values, values, of["args"]):
            if asked is OPEN and value is not OPEN and not alike(theta.setdefault(e["var"], value), value):
                raise Failed("no answer")
        below.theta = theta

    def gone(self, i):
        """It has no frames any more."""
        i.alive = False
        self.intentions.remove(i)
        self.timers = [t for t in self.timers if t.i is not i]

    def stop_waiting(self, i):
        """Whatever it waits for, it waits no more."""
        i.touched, i.held, i.doing = True, False, None
        self.ready = [r for r in self.ready if r is not i]
        self.awaiting = [a for a in self.awaiting if a[0] is not i]
        self.requests = {n: r for n, r in self.requests.items() if r[0] is not i}
        self.events = [e for e in self.events if e.i is not i]
        self.timers = [t for t in self.timers if t.i is not i or t.frame]
        if i.fork:
            group, i.fork = i.fork, None
            for branch in group.members:
                self.drop(branch)

    def drop(self, i):
        self.log("dropped", i)
        self.stop_waiting(i)
        self.gone(i)
        if i.question:
            self.reply(i.question, None)

    def cut(self, i, height):
        """Takes off the frames above."""
        while len(i.frames) > height:
            self.stop_timer(i.frames.pop().timer)

    def branch_ended(self, i, well):
        """A branch of a fork is finished (well), has failed, or was dropped (None)."""
        group = i.group
        group.members.remove(i)
        parent = group.parent
        if group.every and well is False or not group.every and well:
            for other in group.members:
                self.drop(other)
            group.members = []
        if group.members:
            return
        parent.fork = None
        if group.every and well is not False or not group.every and well:
            self.resume(parent)
        else:
            self.fail(parent, "a branch failed" if group.every else "all branches failed")

    # ── Failure ──

    def fail(self, i, why):
        self.log_failure(i, i.frames[-1], why)
        self.unwind(i)

    def log_failure(self, i, frame, why):
        goal = self.writer.goal(frame.on, frame.values)
        self.log(f"failed {goal} in {frame.plan['label']}: {why}{self.company.place(frame)}", i)

    def unwind(self, i):
        """Takes off frames until a failure plan takes the place of one."""
        while i.frames:
            top = i.frames[-1]
            failed = None if top.is_branch else failed_of(top.on)
            event = failed and Event(failed, top.values, top.annotations, i)
            frame = event and self.select(event)
            i.frames.pop()
            self.stop_timer(top.timer)
            if frame:
                self.push(event, frame)
                return
        self.gone(i)
        if i.question:
            self.reply(i.question, None)
        if i.group:
            self.branch_ended(i, False)

    # ── Beliefs ──

    def add(self, belief, values, annotations):
        if all(name != "source" for name, _ in annotations):
            annotations = annotations + [("source", "self")]
        fact = next((f for f in self.beliefs[belief] if all(map(alike, f.values, values))), None)
        is_new = fact is None
        if is_new:
            fact = Fact(values)
            self.beliefs[belief].append(fact)
        new = []
        for name, value in annotations:
            if not any(n == name and alike(v, value) for n, v in fact.annotations):
                fact.annotations.append((name, value))
                new.append((name, value))
        if new:
            self.log(f"+{self.writer.fact(belief, values)}{self.annotated(belief, new)}")
            self.announce({"belief_added": belief}, values, new)

    def annotated(self, belief, annotations):
        return self.writer.annotations(belief, [(a, written(v)) for a, v in annotations])

    def leave(self, belief, fact):
        self.beliefs[belief].remove(fact)
        self.log(f"-{self.writer.fact(belief, fact.values)}")
        self.announce({"belief_removed": belief}, fact.values, fact.annotations)

    def take_source(self, belief, fact, source):
        if len(fact.sources()) == 1:
            self.leave(belief, fact)
            return
        fact.annotations = [(n, v) for n, v in fact.annotations if n != "source" or not alike(v, source)]
        gone = self.annotated(belief, [("source", source)])
        self.log(f"-{self.writer.fact(belief, fact.values)}{gone}")

    def remove(self, belief, admits, sources, meant):
        """Takes away the first fact's source: of `sources(fact)`, which a warning calls `meant`."""
        others = None
        for fact in list(self.beliefs[belief]):
            if not admits(fact):
                continue
            for own, theta in sources(fact):
                self.take_source(belief, fact, own)
                return theta
            others = others or fact
        if others:
            held, text = ", ".join(map(written, others.sources())), self.writer.fact(belief, others.values)
            self.log(f"warning: -{text} takes away {meant} only, it is held from {held}")

    # ── Goals, from outside of their plans ──

    def pursued(self, how, goal):
        """The arguments of the goal where it is intended, desired, suspended."""
        chosen = [i for i in self.intentions if how != "suspended" or i.suspended]
        found = [f.values for i in chosen for f in i.frames if f.is_of(goal)]
        if how == "desire":
            found += [e.values for e in self.events if e.on == {"goal_added": goal}]
        return found

    def holders(self, goal, admits):
        """The intentions that have the goal, with the place of the lowest frame for it."""
        out = []
        for i in self.intentions:
            place = next((n for n, f in enumerate(i.frames) if f.is_of(goal) and admits(f.values)), None)
            if place is not None:
                out.append((i, place))
        return out

    def drop_with_group(self, i):
        if i.alive:
            self.drop(i)
            if i.group:
                self.branch_ended(i, None)

    def drop_event(self, event):
        if event not in self.events:
            return
        self.events.remove(event)
        if event.i:
            self.drop_with_group(event.i)
        if event.question:
            self.reply(event.question, None)

    def drop_events(self, goal, admits):
        for event in list(self.events):
            if event.on == {"goal_added": goal} and admits(event.values):
                self.drop_event(event)

    def drop_intentions(self, goal, admits):
        for i, _ in self.holders(goal, admits):
            self.drop_with_group(i)

    def drop_desires(self, goal, admits):
        self.drop_events(goal, admits)
        self.drop_intentions(goal, admits)

    def drop_others(self, current):
        own = []
        while current:
            own.append(current)
            current = current.group.parent if current.group else None
        for i in list(self.intentions):
            if i not in own:
                self.drop_with_group(i)

    def suspend(self, goal, admits):
        for i, _ in self.holders(goal, admits):
            for one in i.family():
                self.suspend_one(one)

    def suspend_one(self, i):
        i.suspended = True
        if i in self.ready:
            self.ready.remove(i)
            i.held = True

    def go_on(self, goal, admits):
        for i, _ in self.holders(goal, admits):
            for one in list(i.family()):
                if one.suspended:
                    one.suspended, held, one.held = False, one.held, False
                    if held:
                        self.resume(one)

    def end_goal(self, goal, admits, well):
        for i, place in self.holders(goal, admits):
            if not i.alive:
                continue
            self.stop_waiting(i)
            self.cut(i, place if well else place + 1)
            if well:
                self.resume(i)
            else:
                self.fail(i, ".fail_goal")

    # ── Steps ──

    def step(self, i):
        top = i.frames[-1]
        step = top.next()
        form, of = form_of(step["kind"])
        i.touched = False
        if form not in ("if", "while", "for"):
            self.log(self.writer.step(step, top.theta, top.plan["vars"]), i)
        try:
            goes_on = getattr(Steps(self, i, top), form)(of)
        except (Fault, Failed) as why:
            self.fail(i, str(why))
            return
        if goes_on and i.alive and not i.touched:
            self.resume(i)


def applicable(agent, plan, event):
    """The answers of a plan's trigger and context."""
    trigger, called = plan["trigger"], plan["vars"]
    well_bound(trigger["args"] + [term for _, term in trigger["annotations"]], {}, called)
    first = match_all(trigger["args"], event.values, {}, called)
    if first is None:
        return
    query = Query(agent, called)
    for theta in match_annotations(trigger["annotations"], event.annotations, first, called):
        yield from query.answers(plan["context"], theta)


def fits_one(patterns, event, values):
    """Whether an event is one of these."""
    return any(of_pattern(p, event, values) for p in patterns)


def of_pattern(pattern, event, values):
    each = zip(pattern["args"], values)
    return pattern["event"] == event and all(p == "any" or alike(value_of(p["is"]), v) for p, v in each)


def nanoseconds(seconds):
    """To the nearest nanosecond, a half upwards."""
    exact = seconds * 1e9
    down = math.floor(exact)
    return down + (exact - down >= 0.5)


def said(m, name):
    """A message, as the log has it."""
    one = lambda values: applied(name, map(written, values))
    if m.what not in ("answer", "answers"):
        return f"{PERFORMATIVES.get(m.what, m.what.replace(' ', '_'))} {one(m.values)}"
    if m.values is None:
        return "answer nothing"
    return f"answer [{', '.join(map(one, m.values))}]" if m.what == "answers" else "answer " + one(m.values)


def typed_goal(params, values, asked):
    """What a goal gives, as its declaration has it."""
    values = [value if want is OPEN else OPEN for value, want in zip(values, asked)]
    fitting = values if params is None else typed(params, values)
    if fitting is None:
        raise Failed("a value is not of its type")
    return fitting


def named_goals(program, number):
    """The goals that internal actions and messages of `unachieve` name: their frames do not leave early."""
    found = set()

    def look(data):
        if isinstance(data, list):
            for part in data:
                look(part)
        elif isinstance(data, dict):
            for form, of in data.items():
                if form == "control" and of["goal"]:
                    found.add(of["goal"][0])
                elif form in ("intend", "desire", "suspended"):
                    found.add(of["goal"])
                look(of)

    look(program["agents"][number]["plans"])
    look(program["agents"][number]["rules"])
    for content in unachieved(program["agents"]):
        found.add((program["contents"][content]["of"][number] or {}).get("goal"))
    return found


def unachieved(data):
    if isinstance(data, list):
        return [c for part in data for c in unachieved(part)]
    if not isinstance(data, dict):
        return []
    own = [data["send"]["content"]] if "send" in data and data["send"]["performative"] == "unachieve" else []
    return own + [c for part in data.values() for c in unachieved(part)]
