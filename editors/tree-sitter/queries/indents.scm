[
  (enum_body)
  (record_body)
  (stimulus_body)
  (agent_body)
  (plan_body)
  (automaton_body)
  (function_body)
  (location_body)
  (cross_body)
  (suite_body)
  (test_body)
  (script_body)
  (world_body)
  (device_body)
  (system_body)
  (binding_body)
  (entries)
  (parameters)
  (arguments)
  (tuple)
  (list)
  (annotations)
  (if_expression)
  (if_range)
] @indent.begin

["}" ")" "]"] @indent.branch @indent.end

; The second line of a declaration without braces.
[
  (require_declaration)
  (cover_declaration)
  (query_declaration)
  (signal)
  (rule)
  (command)
  (state)
  (belief_rule)
] @indent.begin

(comment) @indent.auto
(string) @indent.ignore
(ERROR) @indent.auto
