"""A harness of protocol 2 for one program, with a graph of ports, and a script of what comes from outside."""

import heapq
import json

HEARS = {"publisher": "subscriber", "client": "server", "action_client": "action_server"}


class Refused(Exception):
    """Nothing happened."""


def misfit(publisher, subscriber):
    """The policy of which a subscriber requests more than a publisher offers."""
    for policy, offered, requested in (("reliability", "best_effort", "reliable"), ("durability", "volatile", "transient_local")):
        if publisher.get(policy) == offered and subscriber.get(policy) == requested:
            return policy
    return None


class System:
    """Answers requests.

    `arrivals` are pairs of a time in nanoseconds and an arrival as the protocol has it; {"topic": NAME, "message": M} is
    published from outside, and a function is called with the system. `services` are functions from a message to a message by
    their names; `actions` functions from a goal to a list of (delay, feedback) and (delay, end, result); `commands` is a
    function from an `act` to (delay, error or None), `signals` and `states` have values by their names, and `latched` the
    last messages of topics from outside, and `parameters` values by their names. `events` are those that the actor hears; None: all. `end` is the end of the test.
    Actions from outside do not say that they accept goals unless the system `accepts`."""

    def __init__(self, arrivals=(), services=(), actions=(), commands=None, signals=(), states=(), events=None,
                 latched=(), end=None, others=(), accepts=True, parameters=()):  # fmt: skip
        self.time, self.stopped, self.lines = 0, False, 0
        self.services, self.actions, self.signals, self.states = map(dict, (services, actions, signals, states))
        self.commands = commands or (lambda request: (0, None))
        self.events, self.end, self.others, self.accepts = events, end, list(others), accepts
        self.mailbox, self.refused, self.ports, self.calls, self.goals = [], [], {}, {}, {}
        self.awaited, self.failures, self.logged = [], [], []
        self.latched, self.published, self.watched = dict(latched), [], False
        self._queue, self._number = [], 0
        self.parameters = {}
        for name, value in dict(parameters).items():
            self.do_set_parameter({"name": name, "value": value})
        for time, arrival in arrivals:
            self.later(time, arrival)

    def later(self, time, arrival):
        """At this time."""
        self._number += 1
        heapq.heappush(self._queue, (time, self._number, arrival))

    def soon(self, delay, arrival):
        self.later(self.time + delay, arrival)

    def answer(self, line):
        """The reply to a line; None: there is none."""
        self.lines += 1
        request = json.loads(line)
        one_way = getattr(self, "tell_" + request["request"], None)
        if request.get("reply") is False:
            one_way = getattr(self, "do_" + request["request"])
        try:
            if one_way is not None:
                one_way(request)
                return None
            reply = getattr(self, "do_" + request["request"], self._yes)(request)
        except Refused as why:
            if one_way is not None:
                self.refused.append({"line": self.lines, "error": str(why)})
                return None
            reply = {"error": str(why)}
        if self.end is not None and self.time >= self.end:
            self.time, self.stopped = self.end, True
        if self.stopped:
            reply = {"stop": True}
        if self.refused:
            reply["refused"], self.refused = self.refused, []
        return {"t": self.time, **reply}

    def _yes(self, request):
        return {"ok": True}

    def do_hello(self, request):
        return {"version": 2, "program": "robot"}

    # ── parameters ──

    def _above(self, name, make=False):
        """The dictionary that has a parameter, or would, and the last part of its name."""
        place, parts = {"": self.parameters}, [""] + [part for part in name.split("/") if part]
        for part in parts[:-1]:
            if not isinstance(place.get(part), dict):
                if not make:
                    return {}, ""
                place[part] = {}
            place = place[part]
        return place, parts[-1]

    def do_get_parameter(self, request):
        place, own = self._above(request["name"])
        if not request["name"].strip("/"):
            return {"value": self.parameters}
        return {"value": place[own]} if own in place else {"ok": False, "error": "there is none"}

    def do_set_parameter(self, request):
        place, own = self._above(request["name"], make=True)
        if own:
            place[own] = request["value"]
        else:
            self.parameters = request["value"]
        return {}

    def do_delete_parameter(self, request):
        place, own = self._above(request["name"])
        if not own or own not in place:
            return {"ok": False, "error": "there is none"}
        del place[own]
        return {"ok": True}

    def do_read(self, request):
        return {"value": self.signals.get(request["signal"], 0)}

    def do_state(self, request):
        return {"value": self.states.get(request["device"], [])}

    def do_drop(self, request):
        for name in request["events"]:
            if self.events is not None and name not in self.events:
                raise Refused("no event `%s` that this actor hears" % name)
        names = request["events"]
        self.mailbox = [m for m in self.mailbox if "event" not in m or names and m["event"]["name"] not in names]
        return {}

    def do_act(self, request):
        delay, error = self.commands(request)
        if delay is None:
            return {"ok": False, "error": error}
        ended = {"ended": request["call"], "ok": error is None}
        self.soon(delay, ended if error is None else {**ended, "error": error})
        return {}

    # ── time ──

    def do_sleep(self, request):
        until = self.time + round(request["seconds"] * 10**9)
        while self._queue and self._queue[0][0] < until:
            self._arrive()
        self.time = until
        return {}

    def do_wait(self, request):
        until, give_up = request.get("until"), request.get("give_up")
        if self.refused:
            until, give_up = self.time, None
        while not self.mailbox:
            next = self._queue[0][0] if self._queue else None
            limits = [time for time in (until, give_up) if time is not None]
            if next is not None and (until is None or next < until) and (give_up is None or next <= max(give_up, self.time)):
                self._arrive()
                continue
            if not limits:
                self.stopped = True
                return {}
            self.time = max(self.time, min(limits))
            if until is None or give_up is not None and give_up < until:
                return {"arrivals": [], "gave_up": True}
            return {"arrivals": []}
        arrivals, self.mailbox = self.mailbox, []
        return {"arrivals": arrivals}

    def _arrive(self):
        time, _, arrival = heapq.heappop(self._queue)
        self.time = max(self.time, time)
        if callable(arrival):
            arrival(self)
        elif "topic" in arrival:
            self.publish(arrival["topic"], arrival["message"])
        else:
            if "event" in arrival:
                arrival["event"].setdefault("args", {})
                arrival["event"].setdefault("time", self.time)
            self.mailbox.append(arrival)

    # ── ports ──

    def do_open(self, request):
        for port in self.ports.values():
            if port["name"] == request["name"] and port["type"] != request["type"]:
                told = request["name"], port["type"], request["type"]
                raise Refused("the topic `%s` is of type `%s`, not `%s`" % told)
        self._changed()
        for number, port in self.ports.items():
            if port["name"] == request["name"] and {port["kind"], request["kind"]} == {"publisher", "subscriber"}:
                pair = (port, request) if port["kind"] == "publisher" else (request, port)
                policy = misfit(*pair)
                if policy is not None:
                    self.mailbox += [{"incompatible": at, "policy": policy} for at in (request["port"], number)]
        self.ports[request["port"]] = request
        is_late = request["kind"] == "subscriber" and request.get("durability") != "volatile"
        if is_late and request["name"] in self.latched:
            self.mailbox.append({"port": request["port"], "message": self.latched[request["name"]]})
        return {}

    def do_list(self, request):
        self.watched = True
        ports = [{key: port[key] for key in ("kind", "name", "type")} for port in self.ports.values()]
        return {"ports": [{**port, "program": port.get("program", "robot")} for port in ports + self.others]}

    def _changed(self):
        if self.watched:
            self.watched = False
            self.mailbox.append({"changed": True})

    def others_open(self, kind, name, type_name):
        """Another program opens a port, which is listed."""
        self.others.append({"kind": kind, "name": name, "type": type_name, "program": "other"})
        self._changed()

    def at(self, kind, name):
        """The numbers of the program's ports of this kind."""
        return [number for number, port in self.ports.items() if port["kind"] == kind and port["name"] == name]

    def publish(self, name, message, publisher=()):
        """From outside, or by a port of the program."""
        for number in self.at("subscriber", name):
            if misfit(dict(publisher), self.ports[number]) is not None:
                continue
            depth = self.ports[number].get("depth", 1000)
            waiting = [m for m in self.mailbox if m.get("port") == number]
            if len(waiting) >= depth:
                self.mailbox.remove(waiting[0])
            self.mailbox.append({"port": number, "message": message})

    def _port(self, request):
        if request["port"] not in self.ports:
            raise Refused("no port %d is open" % request["port"])
        return self.ports[request["port"]]

    def tell_close(self, request):
        self._port(request)
        del self.ports[request["port"]]
        self.mailbox = [m for m in self.mailbox if m.get("port") != request["port"]]
        self._changed()

    def tell_publish(self, request):
        port = self._port(request)
        self.published.append((self.time, port["name"], request["message"]))
        if port.get("latched") or port.get("durability") == "transient_local":
            self.latched[port["name"]] = request["message"]
        self.publish(port["name"], request["message"], port)

    def tell_await(self, request):
        self.awaited.append(request)

    def tell_failed(self, request):
        self.failures.append((self.time, request["node"], request["text"]))

    def tell_log(self, request):
        self.logged.append((self.time, request["level"], request["node"], request["text"]))

    def tell_transition(self, request):
        pass

    def tell_machine(self, request):
        pass

    def tell_call(self, request):
        port, call = self._port(request), request["call"]
        name, message = port["name"], request["message"]
        servers = self.at(HEARS[port["kind"]], name)
        if servers:
            self._number += 1
            self.calls[self._number], self.goals[call] = call, self._number
            self.mailbox.append({"called": self._number, "port": servers[0], "message": message})
        elif name in self.services:
            answer = self.services[name](message)
            told = {"error": answer} if isinstance(answer, str) else {"message": answer}
            self.mailbox.append({"answered": call, **told})
        elif name in self.actions:
            self.goals[call] = None
            steps = self.actions[name](message)
            if self.accepts and [what[0] for _, *what in steps] != ["rejected"]:
                self.mailbox.append({"accepted": call, "text": "it begins"})
            for delay, *what in steps:
                if len(what) == 1:
                    self.soon(delay, lambda _, w=what: self._goal_says(call, {"feedback": call, "message": w[0]}))
                else:
                    told = {"finished": call, "end": what[0], "message": what[1]}
                    self.soon(delay, lambda _, told=told: self._goal_says(call, told))
        else:
            kind = "action" if port["kind"].startswith("action") else "service"
            self.mailbox.append({"answered": call, "error": "the %s `%s` has no server" % (kind, name)})

    def _goal_says(self, call, arrival):
        if call in self.goals:
            self.mailbox.append(arrival)
            if "finished" in arrival:
                del self.goals[call]

    def call(self, name, message, kind="server"):
        """A call, or a goal, from outside: its number."""
        self._number += 1
        self.calls[self._number] = None
        for number in self.at(kind, name):
            self.mailbox.append({"called": self._number, "port": number, "message": message})
        return self._number

    def _end(self, request, arrival):
        if request["call"] not in self.calls:
            raise Refused("no call %d is open" % request["call"])
        call = self.calls.pop(request["call"])
        if call is not None:
            self.goals.pop(call, None)
            self.mailbox.append({**arrival, next(iter(arrival)): call})

    def tell_respond(self, request):
        told = {key: request[key] for key in ("message", "error") if key in request}
        self._end(request, {"answered": 0, **told})

    def tell_feedback(self, request):
        call = self.calls.get(request["call"])
        if call is not None:
            self.mailbox.append({"feedback": call, "message": request["message"]})

    def tell_accept(self, request):
        self._about_goal(request, "accepted")

    def tell_answer_cancel(self, request):
        self._about_goal(request, "cancel_answered", granted=request["granted"])

    def _about_goal(self, request, kind, **members):
        call = self.calls[request["call"]]
        if call is not None:
            text = {"text": request["text"]} if request.get("text") else {}
            self.mailbox.append({kind: call, **members, **text})

    def tell_finish(self, request):
        text = {"text": request["text"]} if request.get("text") else {}
        self._end(request, {"finished": 0, "end": request["end"], "message": request["message"], **text})

    def tell_cancel(self, request):
        for call in [request["call"]] if "call" in request else list(self.goals):
            if self.goals.get(call) is not None:
                number = self.goals[call]
                port = next(p for p, port in self.ports.items() if port["kind"] == "action_server")
                self.mailbox.append({"canceled": number, "port": port})
            elif call in self.goals:
                self.mailbox.append({"cancel_answered": call, "granted": True})
                self.mailbox.append({"finished": call, "end": "canceled", "message": None, "text": "as asked"})
                del self.goals[call]
