"""Plays the cases of `hrdsl conformance` with the SDK for Python: driver.py STEPS."""

import collections
import json
import sys

import hrdsl
from hrdsl.exchange import the_exchange
from hrdsl.mailbox import Mailbox

node = hrdsl.Node("driver")
exchange = the_exchange()

ports = {}  # by their names
calls = {}  # by their names
served = {}  # numbers of calls that arrived at a server, by their names
served_names = {}  # the names of these numbers
counts = collections.Counter()  # how many calls have arrived at each server
arrived = Mailbox()


# ── what arrives ──


def hear_at(name):
    """The handler of a port."""

    def hear(arrival):
        shown = {**arrival, "port": name}
        if "called" in arrival:
            counts[name] += 1
            call = "%s%d" % (name, counts[name])
            served[call], served_names[arrival["called"]] = arrival["called"], call
            shown["called"] = call
        if "canceled" in arrival:
            shown["canceled"] = served_names[arrival["canceled"]]
        arrived.put(shown)

    return hear


def hear_of(name):
    """The handler of a call."""

    def hear(arrival):
        key = next(key for key in ("answered", "accepted", "feedback", "cancel_answered", "finished") if key in arrival)
        arrived.put({**arrival, key: name})

    return hear


# ── the steps ──


def now():
    return {"t": round(node.now() * 1e9)}


def emit(event, args):
    node.emit(event, **args)
    return {}


def sleep(seconds):
    node.sleep(seconds)
    return now()


def wait_for(events, timeout=None):
    event = node.wait_for(*events, timeout=timeout)
    shown = None if event is None else {"name": event.name, "args": event.args, "time": round(event.time * 1e9)}
    return {**now(), "event": shown}


def drop(events):
    node.drop(*events)
    return {}


def read(signal):
    return {"value": node.read(signal)}


def act(on, command, args):
    device = node.device(on)
    if device.command(command, **args):
        return {**now(), "ok": True}
    return {**now(), "ok": False, "error": device.last_error}


def wait(count, timeout=None):
    deadline = None if timeout is None else exchange.time + round(timeout * 1e9)
    got = []
    while len(got) < count:
        item = arrived.get(None if deadline is None else max(1, deadline - exchange.time))
        if item is None:
            break
        got.append(item)
    return {**now(), "arrivals": got}


def begin(on, command, args, **named):
    began = []

    def ended(error):
        if not began:  # it could not be begun
            began.append(error)
        else:
            told = {} if error is None else {"error": error}
            arrived.put({"ended": named["as"], "ok": error is None, **told})

    exchange.act(on, command, args, ended)
    if began:
        return {"ok": False, "error": began[0]}
    began.append(None)
    return {}


def open_(kind, name, type, **options):
    own = options.pop("as")
    port = ports[own] = exchange.open(kind, name, type, handler=hear_at(own), **options)
    port.on_incompatible = lambda policy: arrived.put({"incompatible": own, "policy": policy})
    return {}


def close(port):
    ports.pop(port).close()
    return {}


def publish(port, message=None, count=None):
    for each in [message] if count is None else range(count):
        ports[port].publish(each)
    return {}


def call(port, message, **named):
    calls[named["as"]] = ports[port].call(message, hear_of(named["as"]))
    return {}


def respond(call, message=None, error=None):
    if error is None:
        exchange.respond(served[call], message)
    else:
        exchange.refuse(served[call], error)
    return {}


def accept(call, text=""):
    exchange.accept(served[call], text)
    return {}


def feedback(call, message):
    exchange.feedback(served[call], message)
    return {}


def answer_cancel(call, granted, text=""):
    exchange.answer_cancel(served[call], granted, text)
    return {}


def finish(call, end, message, text=""):
    exchange.finish(served[call], end, message, text)
    return {}


def cancel(call=None, port=None):
    if port is None:
        calls[call].cancel()
    else:
        ports[port].cancel_all()
    return {}


def list_():
    return {"ports": exchange.listing()}


def state(device, what):
    return {"value": exchange.state(device, what)}


def plan(**request):
    return asked(request="plan", **request)


def machine(**told):
    exchange.tell({"request": "machine", **told})
    return {}


def transition(machine, label, state, outcome, next):
    exchange.transition(machine, label, state, outcome, next)
    return {}


def get_parameter(name):
    return asked(request="get_parameter", name=name)


def set_parameter(name, value):
    exchange.link.request({"request": "set_parameter", "name": name, "value": value})
    return {}


def delete_parameter(name):
    return asked(request="delete_parameter", name=name)


def asked(**request):
    answer = exchange.link.request(request)
    told = ("value", "times", "velocities", "accelerations", "ok", "error")
    return {key: answer[key] for key in told if key in answer}


def failed(**told):
    exchange.tell({"request": "failed", **told})
    return {}


def log(**told):
    exchange.tell({"request": "log", **told})
    return {}


def refusals():
    """Each is raised, by a request of its own."""
    refused = []
    while True:
        try:
            node.now()
            return {"refused": refused}
        except hrdsl.ProtocolError as error:
            refused.append(error.message)


STEPS = {"open": open_, "list": list_}


def outcome(do, **step):
    try:
        return STEPS.get(do, globals().get(do))(**step)
    except hrdsl.ProtocolError as error:
        return {"error": error.message}


exchange.on_event(lambda event: arrived.put({"event": event}))
exchange.on_change(lambda: arrived.put({"changed": True}))
with open(sys.argv[1], encoding="utf-8") as steps:
    for line in steps:
        try:
            print(json.dumps(outcome(**json.loads(line))))
        except hrdsl.Stopped:
            print(json.dumps({"stopped": True}))
            raise
