; Later patterns win where two fit.

(identifier) @variable
(comment) @comment
((comment) @comment.documentation
  (#match? @comment.documentation "^///([^/]|$)"))

; ── Literals ──

(string) @string
(escape_sequence) @string.escape
(integer) @number
(float) @number.float
(quantity value: (_) @number)
(unit) @type.builtin
(boolean) @boolean
(wildcard) @variable.builtin

; ── Marks ──

["(" ")" "{" "}" "[" "]"] @punctuation.bracket
["," ";" ":" "."] @punctuation.delimiter
["->" "-->" ".." "=" "+=" "-=" "|" "||" "&&" "!" "!!" "==" "!=" "<" "<=" ">" ">=" "+" "-" "*" "/" "%" "?" "-+" "@" "~"] @operator
(trigger_kind) @operator

; ── Keywords ──

[
  "scenario" "actor" "const" "event" "stimulus" "agent" "var" "channel" "automaton" "network" "query" "require"
  "assume" "cover" "cross" "suite" "part" "device" "world" "system" "test" "from" "to" "by" "in" "plays" "when" "on"
  "do" "emit" "within" "sample" "hold" "belief" "goal" "plan" "rule" "clock" "location" "invariant" "select" "after"
  "causes" "forbids" "precedes" "until" "never" "globally" "always" "eventually" "whenever" "formula" "implies" "since"
  "once" "historically" "before" "between" "at" "most" "least" "exactly" "count" "bins" "bin" "ignore" "agents"
  "search" "random" "of" "choose" "one" "any" "per" "where" "explore" "stop" "minimise" "witness" "delays" "diverse"
  "boundary" "tests" "warmup" "horizon" "patience" "reach" "each" "edge" "stimuli" "length" "pause" "seed" "method"
  "because" "predicts" "meanwhile" "with" "step" "gravity" "body" "joint" "arm" "gripper" "base" "laser" "limb"
  "figure" "posture" "packages" "argument" "semantics" "start" "walls" "current" "signal" "rotated" "mass" "stiffness"
  "ghost" "graspable" "axis" "limits" "effort" "rotor" "damping" "friction" "mimic" "times" "height" "contact" "avoids"
  "fingers" "force" "limbs" "tip" "tool" "speed" "delay" "sideways" "turn" "acceleration" "timeout" "angles" "beams"
  "range" "every" "late" "noise" "drift" "dropout" "flip" "outlier" "facing" "left" "right" "ahead" "behind" "command"
  "state" "expect" "run" "coverage" "limit" "budget" "cpu" "wall" "memory" "output" "env" "online" "program" "ros1"
  "ros2" "messages" "topic" "service" "action" "group" "parameter" "transition" "out" "drives" "latched" "plans"
] @keyword
"fn" @keyword.function
"return" @keyword.return
["for" "fork" "while"] @keyword.repeat
(never_pattern "while" @keyword)
(while_scope "while" @keyword)
(duration_pattern "for" @keyword)
["enum" "record"] @keyword.type
["init" "urgent" "committed" "broadcast"] @keyword.modifier
(channel_declaration "joint" @keyword.modifier)
["if" "else"] @keyword.conditional
["await" "wait"] @keyword.coroutine
"use" @keyword.import
"allow" @keyword.directive
["not" "and" "or" "imply"] @keyword.operator
(between_scope "and" @keyword)
["sup" "inf"] @function.builtin
(quantifier) @operator
(fork_step ["and" "or"] @keyword.repeat)
(boolean ["true" "false"] @boolean)

; ── Names where they are declared ──

(scenario_declaration name: (identifier) @module)
(use_declaration module: (identifier) @module)
(use_declaration module: (path (identifier) @module))
(use_declaration file: (string) @string.special.path)
(allow code: (identifier) @constant)
(enum_declaration name: (identifier) @type)
(enum_body value: (identifier) @constant)
(record_declaration name: (identifier) @type)
(record_field name: (identifier) @variable.member)
(instance_declaration name: (identifier) @type)
(instance_declaration template: (identifier) @type)
(actor_declaration name: (identifier) @type)
(actor_declaration role: (identifier) @type.builtin)
(const_declaration name: (identifier) @constant)
(event_name name: (identifier) @function)
(event_declaration from: (identifier) @type)
(event_declaration to: (identifier) @type)
(parameter name: (identifier) @variable.parameter)
(stimulus_declaration name: (identifier) @function)
(stimulus_declaration by: (identifier) @type)
(agent_declaration name: (identifier) @type)
(agent_declaration plays: (identifier) @type)
(belief name: (identifier) @function)
(belief event: (identifier) @function)
(goal_type name: (identifier) @function)
(plan label: (identifier) @label)
(plan mode: (identifier) @attribute)
(automaton_declaration name: (identifier) @type)
(automaton_declaration plays: (identifier) @type)
(participant automaton: (identifier) @type)
(function_declaration name: (identifier) @function)
(for_statement name: (identifier) @variable)
(query_declaration name: (identifier) @constant)
(query_declaration network: (identifier) @type)
(location name: (identifier) @label)
(edge from: (identifier) @label)
(edge to: (identifier) @label)
(network_declaration name: (identifier) @type)
(network_declaration automaton: (identifier) @type)
(require_declaration name: (identifier) @constant)
(require_declaration kind: (identifier) @attribute)
(cover_declaration name: (identifier) @constant)
(bin name: (identifier) @constant)
(cross_declaration name: (identifier) @constant)
(cross_declaration point: (identifier) @constant)
(suite_declaration name: (identifier) @type)
(agents_method agent: (identifier) @type)
(search_method network: (identifier) @type)
(choose agent: (identifier) @type)
(choose belief: (identifier) @function)
(test_declaration name: (identifier) @type)
(test_declaration name: (path (identifier) @type))
(script actor: (identifier) @type)
(sampled name: (identifier) @variable.parameter)
(part_declaration name: (identifier) @type)
(placement part: (identifier) @type)
(body motion: (identifier) @attribute)
(body shape: (identifier) @type.builtin)
(signal to: (identifier) @type)
(device_declaration kind: (identifier) @type.builtin)
(command name: (identifier) @function)
(command primitive: (identifier) @function.builtin)
(state name: (identifier) @property)
(state told: (identifier) @function.builtin)
(expectation measure: (identifier) @function.builtin)
(system_declaration name: (identifier) @type)
(system_declaration actor: (identifier) @type)
(program name: (identifier) @type)
(setting "messages" value: (string) @string.special.path)
(topic name: (string) @string.special.path)
(service name: (string) @string.special.path)
(action name: (string) @string.special.path)
(interface package: (identifier) @module)
(interface kind: (identifier) @module)
(interface name: (identifier) @type)
(field_entry field: (identifier) @variable.member)
(field_entry field: (path . (identifier) @variable.member))
(field_entry field: (index_expression value: (identifier) @variable.member))
(field_entry field: (index_expression value: (path . (identifier) @variable.member)))

; ── Names where they are used ──

(named_type name: (identifier) @type)
((named_type name: (identifier) @type.builtin)
  (#any-of? @type.builtin
    "bool" "clock" "int" "string" "time" "length" "angle" "mass" "force" "speed" "angular_speed" "float" "number"))
(template_type ["event" "actor" "cover" "agent"] @type.builtin)
(call name: (identifier) @function.call)
(rule command: (identifier) @function.method.call)
(command_entry command: (identifier) @function.method.call)
(call_expression function: (identifier) @function.call)
(call_expression function: (path (identifier) @function.call .))
(act_step action: (path (identifier) @function.method.call .))
(trigger call: (call name: (identifier) @function.method))
(achieve_step (call name: (identifier) @function.method))
(spawn_step (call name: (identifier) @function.method))
(goal goal: (call name: (identifier) @function.method))
(belief_rule head: (call name: (identifier) @function))
(internal_action name: (identifier) @function.builtin)
(field_expression field: (identifier) @variable.member)
(path "." . (identifier) @variable.member)

; ── Faults ──

(missing_brace) @error
