"""Agents and the harness, rule by rule, and slowly, as these pages define them: `spec/agents.md`,
`spec/agents-semantics.md`, `spec/internal-actions.md`, `spec/harness.md`. Nothing here is taken from the code of hrdsl:
where the two differ, one of them or the specification is wrong.

Reads a program and the casts of some runs as JSON, and prints of each run the log, the events that happened (lines that
begin with `event`), how it ended (`ended: quiescent`), and a line `.`:

    {"program": …, "sources": ["the text of file 0"], "limit": 60000000000,
     "runs": [[{"agent": 0, "chosen": [a Fact, …]}, …], …]}

The parts: values and expressions (`agent_values`), matching and queries (`agent_queries`), the state (`agent_state`), the
machine (`agent_machine`), its steps (`agent_steps`), what the log says (`agent_text`); rounds and the harness are here.
What is left out: the world, automata, samples of stimuli, `.random` and `.shuffle`.
"""

import json
import sys
import threading

from agent_machine import FIRST_STATE, Agent, nanoseconds
from agent_text import time_text
from agent_values import evaluate, written

EVENTS = 10_000  # at one instant
CYCLES = 1_000_000  # of one agent at one instant


class Ended(Exception):
    """The run is over, and how."""


class Company:
    """The agents of a run, in their order, and the rounds in which they act."""

    def __init__(self, program, cast, sources, cycles):
        self.cycles = cycles
        self.now, self.lines, self.requests = 0, [], 0
        self.sources = [text.encode() for text in sources]
        self.agents = [Agent(self, program, one["agent"]) for one in cast]
        for agent, one in zip(self.agents, cast):
            agent.start(one["chosen"])

    def log(self, name, text):
        self.lines.append(f"{time_text(self.now)} {name}: {text}")

    def place(self, frame):
        """The line of the step that a frame is at, or of its plan."""
        origin = (frame.at or frame.plan)["origin"]
        if origin["file"] >= len(self.sources):
            return ""
        before = self.sources[origin["file"]][: origin["start"]]
        return f" (line {before.count(10) + 1})"

    def request(self):
        self.requests += 1
        return self.requests

    def pass_to(self, now):
        if now > self.now:
            self.now = now
            for agent in self.agents:
                agent.cycles = 0

    def rounds(self, happen):
        """Until nobody has anything to do at this instant."""
        quiet, remembered, until = 0, None, 0
        while True:
            for agent in self.agents:
                agent.settle()
            self.look_for_ends()
            sent = self.exchange()
            acted = self.act(happen)
            if not sent and not acted:
                return
            quiet = 0 if acted else quiet + 1
            if quiet >= FIRST_STATE:
                if remembered and quiet <= until and [agent.state() for agent in self.agents] == remembered:
                    next(a for a in self.agents if a.inbox).end("livelock")
                    self.look_for_ends()
                if quiet & (quiet - 1) == 0:
                    remembered, until = [agent.state() for agent in self.agents], quiet + quiet // 16

    def look_for_ends(self):
        for agent in self.agents:
            if agent.ended:
                raise Ended(f"{agent.ended} of {agent.name}")

    def exchange(self):
        sent = [one for agent in self.agents for one in agent.outbox]
        for agent in self.agents:
            agent.outbox = []
        for receiver, message in sent:
            receiver.inbox.append(message)
        return bool(sent)

    def act(self, happen):
        acted = False
        for agent in self.agents:
            given, agent.given = agent.given, []
            for i, action, event, values in given:
                acted = True
                stimulus = Stimulus(agent, i, action, event, values, happen)
                if stimulus.is_over():
                    stimulus.let_go()
                else:
                    agent.stimuli.append(stimulus)
        return acted


class Stimulus:
    """A stimulus under way; an event is one without steps."""

    def __init__(self, agent, i, action, event, values, happen):
        self.agent, self.i, self.action, self.until = agent, i, action, agent.company.now
        happen(agent, event, values)
        body = agent.program["events"][event]["stimulus"]
        if body and body["samples"]:
            raise NotImplementedError("samples of stimuli")
        self.steps = list(taken(body["steps"], dict(enumerate(values)))) if body else []
        self.go_on(happen)

    def go_on(self, happen):
        while self.until <= self.agent.company.now and self.steps:
            form, of = self.steps.pop(0)
            if form == "emit":
                happen(self.agent, *of)
            else:
                self.until = self.agent.company.now + of

    def is_over(self):
        return not self.steps and self.until <= self.agent.company.now

    def let_go(self):
        """The intention goes on, if it still waits for this."""
        if self.i.doing is self.action:
            self.i.doing = None
            self.agent.resume(self.i)


def taken(steps, names):
    """The steps of a stimulus that are done."""
    for step in steps:
        ((form, of),) = step.items()
        if form == "if":
            yield from taken(of["then" if evaluate(of["condition"], names) else "otherwise"], names)
        elif form == "emit":
            yield form, (of["event"], [evaluate(a, names) for a in of["args"]])
        elif form == "hold":
            yield form, nanoseconds(max(0, evaluate(of["seconds"], names)))


class Harness:
    """The loop of `spec/harness.md`, without a world, for agents alone."""

    def __init__(self, program, cast, sources, limit, cycles):
        self.program, self.limit = program, limit
        self.company = Company(program, cast, sources, cycles)
        self.queue, self.trace, self.at_instant = [], [], 0
        role = lambda agent: program["actors"][agent.actor]["role"]
        self.players = sorted(self.company.agents, key=lambda agent: role(agent) != "system")

    def happen(self, maker, event, values):
        self.at_instant += 1
        if self.at_instant > EVENTS:
            raise Ended("too many events")
        self.trace.append((self.company.now, self.program["events"][event]["name"], values))
        self.queue.append((maker, event, values))

    def perceives(self, agent, event):
        e = self.program["events"][event]
        if e["stimulus"]:
            return self.program["actors"][agent.actor]["role"] == "environment"
        return not e["to"] or agent.actor in e["to"]

    def deliver(self):
        while self.queue:
            maker, event, values = self.queue.pop(0)
            for agent in self.company.agents:
                if agent is not maker and self.perceives(agent, event):
                    agent.inbox.append((event, values))
            self.company.rounds(self.happen)

    def wake(self, agent, expires):
        over = []
        for stimulus in list(agent.stimuli):
            stimulus.go_on(self.happen)
            if stimulus.is_over():
                agent.stimuli.remove(stimulus)
                over.append(stimulus)
        for stimulus in over:
            stimulus.let_go()
        self.company.rounds(self.happen)
        while expires and any(t.due <= self.company.now for t in agent.timers):
            agent.expire()
            self.company.rounds(self.happen)
        self.deliver()

    def due(self, agent):
        return min([t.due for t in agent.timers] + [s.until for s in agent.stimuli], default=None)

    def loop(self):
        for agent in self.players:
            self.wake(agent, False)
        while True:
            times = [due for due in map(self.due, self.players) if due is not None]
            if not times:
                raise Ended("quiescent")
            if min(times) > self.limit:
                raise Ended("horizon")
            if min(times) > self.company.now:
                self.company.pass_to(min(times))
                self.at_instant = 0
            for expires in (False, True):
                for agent in self.players:
                    due = self.due(agent)
                    if due is not None and due <= self.company.now:
                        self.wake(agent, expires)

    def run(self):
        try:
            self.loop()
        except Ended as how:
            return str(how)


def main():
    given = json.load(sys.stdin)
    for cast in given["runs"]:
        cycles = given.get("cycles", CYCLES)
        harness = Harness(given["program"], cast, given.get("sources", []), given["limit"], cycles)
        ended = harness.run()
        print(*harness.company.lines, sep="\n")
        for time, name, values in harness.trace:
            print("event", time, name, *map(written, values))
        print(f"ended: {ended}")
        print(".")


if __name__ == "__main__":
    # Queries call each other as deeply as rules do.
    sys.setrecursionlimit(10**6)
    threading.stack_size(512 * 2**20)
    thread = threading.Thread(target=main)
    thread.start()
    thread.join()
