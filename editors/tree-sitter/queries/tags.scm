; The outline: what a file declares.

(scenario_declaration name: (identifier) @name) @definition.module
(enum_declaration name: (identifier) @name) @definition.type
(record_declaration name: (identifier) @name) @definition.type
(actor_declaration name: (identifier) @name) @definition.interface
(const_declaration name: (identifier) @name) @definition.constant
(event_name name: (identifier) @name) @definition.function
(stimulus_declaration name: (identifier) @name) @definition.function
(agent_declaration name: (identifier) @name) @definition.class
(automaton_declaration name: (identifier) @name) @definition.class
(instance_declaration name: (identifier) @name) @definition.class
(function_declaration name: (identifier) @name) @definition.function
(query_declaration name: (identifier) @name) @definition.constant
(network_declaration name: (identifier) @name) @definition.class
(require_declaration name: (identifier) @name) @definition.constant
(cover_declaration name: (identifier) @name) @definition.constant
(cross_declaration name: (identifier) @name) @definition.constant
(suite_declaration name: (identifier) @name) @definition.class
(test_declaration name: (_) @name) @definition.class
(part_declaration name: (identifier) @name) @definition.class
(system_declaration !name actor: (identifier) @name) @definition.class
(system_declaration name: (identifier) @name) @definition.class

(belief name: (identifier) @name) @definition.field
(command name: (identifier) @name) @definition.method
(state name: (identifier) @name) @definition.field
(belief_rule head: (call name: (identifier) @name)) @definition.method
(goal_type name: (identifier) @name) @definition.field
(plan trigger: (trigger call: (call name: (identifier) @name))) @definition.method
(var_declaration name: (identifier) @name) @definition.variable
(location name: (identifier) @name) @definition.field
(body name: (identifier) @name) @definition.field
(joint name: (identifier) @name) @definition.field
(arm name: (identifier) @name) @definition.field
(gripper name: (identifier) @name) @definition.field
(base name: (identifier) @name) @definition.field
(laser name: (identifier) @name) @definition.field
(posture name: (identifier) @name) @definition.field
(current name: (identifier) @name) @definition.field
(signal name: (identifier) @name) @definition.field
(placement name: (identifier) @name) @definition.field
(program name: (identifier) @name) @definition.field
(topic name: (string (string_content) @name)) @definition.field
(service name: (string (string_content) @name)) @definition.field
(action name: (string (string_content) @name)) @definition.field

; Where they are used.

(call name: (identifier) @name) @reference.call
(call_expression function: (identifier) @name) @reference.call
(instance_declaration template: (identifier) @name) @reference.class
(agent_declaration plays: (identifier) @name) @reference.interface
(automaton_declaration plays: (identifier) @name) @reference.interface
(system_declaration name: (_) actor: (identifier) @name) @reference.interface
(participant automaton: (identifier) @name) @reference.class
(named_type name: (identifier) @name) @reference.type
