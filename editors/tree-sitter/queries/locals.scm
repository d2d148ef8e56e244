; Scopes

(source_file) @local.scope
(stimulus_declaration) @local.scope
(agent_declaration) @local.scope
(plan) @local.scope
(belief_rule) @local.scope
(automaton_declaration) @local.scope
(function_declaration) @local.scope
(for_statement) @local.scope
(edge) @local.scope
(require_declaration) @local.scope
(cover_declaration) @local.scope
(cross_declaration) @local.scope
(part_declaration) @local.scope
(world_declaration) @local.scope

; Definitions. The names of declarations that are scopes themselves are not here: they would be known only within.

(enum_declaration name: (identifier) @local.definition)
(enum_body value: (identifier) @local.definition)
(record_declaration name: (identifier) @local.definition)
(actor_declaration name: (identifier) @local.definition)
(const_declaration name: (identifier) @local.definition)
(event_name name: (identifier) @local.definition)
(instance_declaration name: (identifier) @local.definition)
(network_declaration name: (identifier) @local.definition)
(suite_declaration name: (identifier) @local.definition)
(parameter name: (identifier) @local.definition)
(sample_step name: (identifier) @local.definition)
(belief name: (identifier) @local.definition)
(goal_type name: (identifier) @local.definition)
(var_declaration name: (identifier) @local.definition)
(clock name: (identifier) @local.definition)
(for_statement name: (identifier) @local.definition)
(query_declaration name: (identifier) @local.definition)
(placement name: (identifier) @local.definition)
(body name: (identifier) @local.definition)
(joint name: (identifier) @local.definition)
(arm name: (identifier) @local.definition)
(gripper name: (identifier) @local.definition)
(base name: (identifier) @local.definition)
(laser name: (identifier) @local.definition)
(posture name: (identifier) @local.definition)
(current name: (identifier) @local.definition)
(signal name: (identifier) @local.definition)

; References

(identifier) @local.reference
