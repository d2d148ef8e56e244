// Plays the cases of `hrdsl conformance` by the lock-step protocol alone, without any library: node driver.js [VERSION] STEPS.
"use strict";

const fs = require("fs");

const out = Number(process.env.HRDSL_REQUEST_FD);
const into = Number(process.env.HRDSL_REPLY_FD);
const version = process.argv.length > 3 ? Number(process.argv[2]) : 2;

class Stopped extends Error {}
class Refused extends Error {}

// ── the protocol ──

let written = ""; // requests without replies, which go out with the next one
let unread = Buffer.alloc(0);
const refused = [];

function tell(request) {
  written += JSON.stringify(request) + "\n";
}

function ask(request) {
  let text = Buffer.from(written + JSON.stringify(request) + "\n");
  written = "";
  while (text.length > 0) text = text.subarray(fs.writeSync(out, text));
  const reply = JSON.parse(line());
  for (const each of reply.refused || []) refused.push(each.error);
  if (reply.stop) throw new Stopped(reply.reason);
  if ("error" in reply && !("ok" in reply)) throw new Refused(reply.error);
  return reply;
}

function line() {
  const chunk = Buffer.alloc(1 << 16);
  for (;;) {
    const end = unread.indexOf(10);
    if (end >= 0) {
      const text = unread.subarray(0, end).toString();
      unread = unread.subarray(end + 1);
      return text;
    }
    const count = fs.readSync(into, chunk);
    if (count === 0) throw new Stopped("the harness has gone");
    unread = Buffer.concat([unread, chunk.subarray(0, count)]);
  }
}

// ── names of the steps for numbers of the protocol, and back ──

const numbers = {}; // of ports and calls, by their names
const names = []; // of ports and calls, by their numbers
const served = {}; // numbers of calls that arrived at a server, by their names
const servedNames = {};
const counts = {}; // how many have arrived at each server
const arrivals = []; // that no step has shown yet

function number(name) {
  numbers[name] = names.push(name) - 1;
  return numbers[name];
}

function named(arrival) {
  const shown = { ...arrival };
  for (const key of ["port", "ended", "answered", "accepted", "feedback", "cancel_answered", "finished", "incompatible"]) {
    if (key in shown) shown[key] = names[shown[key]];
  }
  if ("called" in shown) {
    counts[shown.port] = (counts[shown.port] || 0) + 1;
    const name = shown.port + counts[shown.port];
    served[name] = arrival.called;
    servedNames[arrival.called] = shown.called = name;
  }
  if ("canceled" in shown) shown.canceled = servedNames[shown.canceled];
  return shown;
}

function collect(count, timeout) {
  let now = ask({ request: "now" }).t;
  const giveUp = timeout === undefined ? undefined : now + Math.round(timeout * 1e9);
  while (arrivals.length < count) {
    const reply = ask({ request: "wait", give_up: giveUp });
    now = reply.t;
    arrivals.push(...reply.arrivals.map(named));
    if (reply.gave_up) break;
  }
  return { t: now, arrivals: arrivals.splice(0, count) };
}

// ── the steps ──

/** Asks, and shows these members of the reply. */
function show(request, ...members) {
  const reply = ask(request);
  return Object.fromEntries(members.filter((key) => key in reply).map((key) => [key, reply[key]]));
}

/** Tells; what comes of it is shown later. */
function told(request) {
  tell(request);
  return {};
}

function about(step, ...members) {
  const rest = Object.fromEntries(members.filter((key) => key in step).map((key) => [key, step[key]]));
  return { request: step.do, ...rest };
}

const steps = {
  now: () => show({ request: "now" }, "t"),
  emit: (step) => show(about(step, "event", "args")),
  sleep: (step) => show({ request: "sleep", seconds: step.seconds }, "t"),
  wait_for: (step) => show(about(step, "events", "timeout"), "t", "event"),
  drop: (step) => show(about(step, "events")),
  read: (step) => show(about(step, "signal"), "value"),
  act: (step) =>
    show({ request: "act", on: step.on, do: step.command, args: step.args, wait: true }, "t", "ok", "error"),

  wait: (step) => collect(step.count, step.timeout),
  begin: (step) => {
    const { on, command, args } = step;
    return show({ request: "act", on, do: command, args, wait: false, call: number(step.as) }, "ok", "error");
  },
  open: (step) => {
    const open = about(step, "kind", "name", "type", "latched", "depth", "reliability", "durability");
    return show({ ...open, port: number(step.as) });
  },
  close: (step) => told({ request: "close", port: numbers[step.port] }),
  publish: (step) => {
    const port = numbers[step.port];
    if (!("count" in step)) return told({ request: "publish", port, message: step.message });
    for (let message = 0; message < step.count; message++) tell({ request: "publish", port, message });
    return {};
  },
  call: (step) => told({ ...about(step, "message"), port: numbers[step.port], call: number(step.as) }),
  respond: (step) => told({ ...about(step, "message", "error"), call: served[step.call] }),
  accept: (step) => told({ ...about(step, "text"), call: served[step.call] }),
  feedback: (step) => told({ ...about(step, "message"), call: served[step.call] }),
  answer_cancel: (step) => told({ ...about(step, "granted", "text"), call: served[step.call] }),
  finish: (step) => told({ ...about(step, "end", "message", "text"), call: served[step.call] }),
  cancel: (step) =>
    told("port" in step ? { request: "cancel", port: numbers[step.port] } : { request: "cancel", call: numbers[step.call] }),
  list: () => show({ request: "list" }, "ports"),
  state: (step) => show(about(step, "device", "what"), "value"),
  plan: (step) => {
    const asked = about(step, "device", "to", "joints", "from", "way", "timed", "speeds", "accelerations");
    return show(asked, "value", "times", "velocities", "accelerations", "ok", "error");
  },
  machine: (step) => told(about(step, "name", "states", "transitions", "outcomes")),
  transition: (step) => told(about(step, "machine", "label", "state", "outcome", "next")),
  get_parameter: (step) => show(about(step, "name"), "value", "ok", "error"),
  set_parameter: (step) => show(about(step, "name", "value")),
  delete_parameter: (step) => show(about(step, "name"), "ok", "error"),
  failed: (step) => told(about(step, "node", "text")),
  log: (step) => told(about(step, "level", "node", "text")),
  refusals: () => {
    ask({ request: "now" });
    return { refused: refused.splice(0) };
  },
};

function outcome(step) {
  try {
    return steps[step.do](step);
  } catch (error) {
    if (error instanceof Refused) return { error: error.message };
    throw error;
  }
}

try {
  ask({ request: "hello", version, name: "driver" });
  for (const text of fs.readFileSync(process.argv.at(-1), "utf8").trim().split("\n")) {
    console.log(JSON.stringify(outcome(JSON.parse(text))));
  }
  fs.writeSync(out, written + JSON.stringify({ request: "done" }) + "\n");
} catch (error) {
  if (!(error instanceof Stopped)) throw error;
  console.log(JSON.stringify({ stopped: true }));
}
