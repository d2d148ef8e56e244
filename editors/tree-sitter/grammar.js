// The grammar of hrdsl for editors. It follows spec/grammar.md and compiler/syntax/src/grammar.lalrpop, and accepts at
// least what they do.
//
// Words are read by src/scanner.c: it knows which are keywords where, so `identifier` never is a reserved word, and a
// soft keyword is a keyword only where one fits.

const KEYWORDS = require("./keywords.json").map((row) => row.word);

// From the loosest operator to the tightest.
const PREC = { IMPLY: 1, OR: 2, AND: 3, REACH: 4, NOT: 5, COMPARE: 6, RANGE: 7, ADD: 8, MULTIPLY: 9, NEGATE: 10 };

/** The external token of a keyword, shown as the word itself. */
function keyword($, word) {
  if (!KEYWORDS.includes(word)) throw new Error(`"${word}" is not in keywords.json`);
  return alias($[`_keyword_${word}`], word);
}

/** One or more, separated. */
const list = (rule, separator = ",") => seq(rule, repeat(seq(separator, rule)));

/** None or more, separated by commas; a last comma is allowed. */
const listed = (rule) => optional(seq(list(rule), optional(",")));

/** Members with optional semicolons. */
const block = ($, member) => seq("{", repeat(choice(member, ";")), closing($));

/** The end of a block, also if it was forgotten: so the next declaration is read as if the block had ended. */
const closing = ($) => choice("}", $.missing_brace);

module.exports = grammar({
  name: "hri",

  externals: ($) => [
    $.identifier,
    $._member, // any word after a dot
    $._origin, // a name before `->`
    $.unit,
    $.quantifier, // `E<>`, `A[]`, `E[]`, `A<>`
    $.missing_brace, // without text, where a declaration begins in a block
    ...KEYWORDS.map((word) => $[`_keyword_${word}`]),
    $._never, // valid only after a fault
  ],

  extras: ($) => [/[ \t\r\n]/, $.comment],

  supertypes: ($) => [$.declaration, $.expression, $.type],

  inline: ($) => [$._range_end],

  conflicts: ($) => [
    // `bool[4]`, and `limits[4] .. 7`.
    [$.named_type, $._path],
    // `var x: T = 1`, and a range, in which no `=` can be.
    [$.named_type, $.expression],
  ],

  rules: {
    source_file: ($) => seq(optional($.scenario_declaration), repeat(choice($.declaration, ";"))),

    scenario_declaration: ($) => seq(keyword($, "scenario"), field("name", $.identifier)),

    declaration: ($) =>
      choice(
        $.use_declaration,
        $.allow,
        $.enum_declaration,
        $.record_declaration,
        $.instance_declaration,
        $.actor_declaration,
        $.const_declaration,
        $.event_declaration,
        $.stimulus_declaration,
        $.agent_declaration,
        $.var_declaration,
        $.automaton_declaration,
        $.channel_declaration,
        $.function_declaration,
        $.query_declaration,
        $.network_declaration,
        $.require_declaration,
        $.assume_declaration,
        $.cover_declaration,
        $.cross_declaration,
        $.suite_declaration,
        $.part_declaration,
        $.device_declaration,
        $.world_declaration,
        $.system_declaration,
        $.test_declaration,
      ),

    // ── Vocabulary ──

    use_declaration: ($) => seq(keyword($, "use"), choice(field("module", $._path), field("file", $.string))),

    allow: ($) => seq(keyword($, "allow"), field("code", $.identifier), field("reason", $.string)),

    enum_declaration: ($) => seq(keyword($, "enum"), field("name", $.identifier), field("body", $.enum_body)),
    enum_body: ($) => seq("{", listed(field("value", $.identifier)), closing($)),

    record_declaration: ($) => seq(keyword($, "record"), field("name", $.identifier), field("body", $.record_body)),
    record_body: ($) => seq("{", listed(alias($.parameter, $.record_field)), closing($)),

    instance_declaration: ($) =>
      seq(
        choice(...["agent", "automaton", "require", "cover", "cross"].map((word) => keyword($, word))),
        field("name", $.identifier),
        "=",
        field("template", $.identifier),
        field("arguments", $.arguments),
      ),

    actor_declaration: ($) =>
      seq(
        keyword($, "actor"),
        field("name", $.identifier),
        ":",
        field("role", choice($.identifier, alias($._keyword_system, $.identifier))),
      ),

    const_declaration: ($) =>
      seq(keyword($, "const"), field("name", $.identifier), "=", field("value", $.expression)),

    event_declaration: ($) =>
      seq(
        keyword($, "event"),
        list($.event_name),
        keyword($, "from"),
        field("from", $.identifier),
        optional(seq(keyword($, "to"), list(field("to", $.identifier)))),
      ),
    event_name: ($) => seq(field("name", $.identifier), optional(field("parameters", $.parameters))),

    parameters: ($) => seq("(", listed($.parameter), ")"),
    // Where something goes, or is brought, is called `to`.
    parameter: ($) =>
      seq(field("name", choice($.identifier, alias($._keyword_to, $.identifier))), ":", field("type", $.type)),

    type: ($) => choice($.named_type, $.template_type, $.range_type, $.array_type, $.list_type),
    named_type: ($) => field("name", $.identifier),
    // What a template can be given besides values.
    template_type: ($) => choice(...["event", "actor", "cover", "agent"].map((word) => keyword($, word))),
    range_type: ($) => prec.left(PREC.RANGE, seq(field("low", $._range_end), "..", field("high", $._range_end))),
    array_type: ($) =>
      choice(
        seq(field("element", choice($.named_type, $.array_type)), "[", field("size", $.expression), "]"),
        seq("(", field("element", $.range_type), ")", "[", field("size", $.expression), "]"),
      ),
    list_type: ($) => seq("[", field("element", $.type), "]"),

    // ── Stimuli ──

    stimulus_declaration: ($) =>
      seq(
        keyword($, "stimulus"),
        field("name", $.identifier),
        optional(field("parameters", $.parameters)),
        keyword($, "by"),
        field("by", $.identifier),
        field("body", $.stimulus_body),
      ),
    stimulus_body: ($) => block($, $._stimulus_step),
    _stimulus_step: ($) => choice($.sample_step, $.emit_step, $.hold_step, $.act_step, $.if_step),
    sample_step: ($) =>
      seq(keyword($, "sample"), field("name", $.identifier), keyword($, "in"), field("range", $._drawn)),
    _drawn: ($) => choice($.range, $.if_range),
    // As with `if_expression`, the compiler wants an `else`; without it here, one that is not yet typed costs less.
    if_range: ($) =>
      seq(
        keyword($, "if"),
        field("condition", $.expression),
        "{",
        field("consequence", $._drawn),
        closing($),
        optional(
          seq(
            keyword($, "else"),
            choice(seq("{", field("alternative", $._drawn), closing($)), field("alternative", $.if_range)),
          ),
        ),
      ),
    emit_step: ($) => seq(keyword($, "emit"), field("event", $.call)),
    hold_step: ($) => seq(keyword($, "hold"), field("time", $.expression)),
    act_step: ($) => seq(field("action", alias($._action_path, $.path)), field("arguments", $.arguments)),
    // An action is always some thing's: two names at least. `sample` and `hold` may be things.
    _action_path: ($) =>
      seq(
        choice(
          $.identifier,
          alias($._keyword_sample, $.identifier),
          alias($._keyword_hold, $.identifier),
        ),
        repeat1($._dot_name),
      ),
    if_step: ($) =>
      seq(
        keyword($, "if"),
        field("condition", $.expression),
        field("consequence", $.stimulus_body),
        optional(seq(keyword($, "else"), field("alternative", choice($.stimulus_body, $.if_step)))),
      ),

    // ── Expressions ──

    expression: ($) =>
      choice(
        $.binary_expression,
        $.unary_expression,
        $.integer,
        $.float,
        $.quantity,
        $.boolean,
        $.string,
        $.list,
        $.wildcard,
        $.identifier,
        $.path,
        $.call_expression,
        $.annotated_expression,
        $.internal_action,
        $.unify_expression,
        $.index_expression,
        $.field_expression,
        $.parenthesized_expression,
        $.tuple,
        $.if_expression,
      ),

    binary_expression: ($) => {
      const rows = [
        [PREC.OR, ["||", keyword($, "or")]],
        [PREC.AND, ["&&", keyword($, "and")]],
        [PREC.COMPARE, ["==", "!=", "<", "<=", ">", ">="]],
        [PREC.ADD, ["+", "-"]],
        [PREC.MULTIPLY, ["*", "/", "%"]],
      ];
      return choice(
        prec.right(
          PREC.IMPLY,
          seq(
            field("left", $.expression),
            field("operator", keyword($, "imply")),
            field("right", $.expression),
          ),
        ),
        ...rows.map(([level, operators]) =>
          prec.left(
            level,
            seq(
              field("left", $.expression),
              field("operator", choice(...operators)),
              field("right", $.expression),
            ),
          ),
        ),
      );
    },

    unary_expression: ($) =>
      choice(
        prec(
          PREC.NOT,
          seq(field("operator", choice(keyword($, "not"), "!", "!!")), field("operand", $.expression)),
        ),
        prec(PREC.NEGATE, seq(field("operator", choice("-", "~")), field("operand", $.expression))),
      ),

    // In conditions of agents: binds or compares.
    unify_expression: ($) =>
      prec.left(PREC.COMPARE, seq(field("left", $.expression), "=", field("right", $.expression))),

    list: ($) =>
      seq("[", optional(seq(list($.expression), optional(seq("|", field("rest", $.expression))))), "]"),

    parenthesized_expression: ($) => seq("(", $.expression, ")"),
    tuple: ($) => seq("(", $.expression, ",", list($.expression), optional(","), ")"),

    if_expression: ($) =>
      seq(
        keyword($, "if"),
        field("condition", $.expression),
        "{",
        field("consequence", $.expression),
        closing($),
        optional(
          seq(
            keyword($, "else"),
            choice(
              seq("{", field("alternative", $.expression), closing($)),
              field("alternative", $.if_expression),
            ),
          ),
        ),
      ),

    call_expression: ($) => seq(field("function", $._path), field("arguments", $.arguments)),
    index_expression: ($) =>
      seq(
        field("value", choice($._path, $.index_expression, $.field_expression)),
        "[",
        field("index", $.expression),
        "]",
      ),
    field_expression: ($) =>
      seq(field("value", choice($.index_expression, $.field_expression)), ".", field("field", $._after_dot)),

    // `b(X)[source(S)]`. One annotation of a name without arguments is an index.
    annotated_expression: ($) =>
      choice(
        seq(field("value", $.call_expression), field("annotations", $.annotations)),
        seq(field("value", $._path), field("annotations", alias($._several_annotations, $.annotations))),
      ),
    annotations: ($) => seq("[", list($.expression), "]"),
    _several_annotations: ($) => seq("[", $.expression, ",", list($.expression), "]"),

    // `.count(b(_), N)`
    internal_action: ($) => seq(".", field("name", $._after_dot), optional(field("arguments", $.arguments))),

    arguments: ($) => seq("(", listed($.expression), ")"),

    _path: ($) => choice($.identifier, $.path),
    path: ($) => seq($.identifier, repeat1($._dot_name)),
    // Rather than an internal action: `hold.sample.emit()`.
    _dot_name: ($) => prec(1, seq(".", $._after_dot)),
    _after_dot: ($) => alias($._member, $.identifier),

    range: ($) => prec.left(PREC.RANGE, seq(field("low", $._range_end), "..", field("high", $._range_end))),
    _range_end: ($) => $.expression,

    quantity: ($) => seq(field("value", choice($.integer, $.float)), field("unit", $.unit)),
    integer: () => /[0-9]+/,
    float: () => /[0-9]+\.[0-9]+([eE][+-]?[0-9]+)?/,
    boolean: ($) => choice(keyword($, "true"), keyword($, "false")),
    wildcard: () => "_",

    string: ($) =>
      seq('"', repeat(choice($.string_content, $.escape_sequence)), token.immediate('"')),
    // Rather than a comment, if it holds `//`.
    string_content: () => token.immediate(prec(1, /[^"\\\n]+/)),
    escape_sequence: () => token.immediate(prec(1, /\\["\\n]/)),

    comment: () => token(/\/\/[^\n]*/),

    // ── Calls and events ──

    call: ($) => seq(field("name", $.identifier), optional(field("arguments", $.arguments))),

    // `a | b`
    await_events: ($) => list($.call, "|"),

    // `a`, `a or b`, `(a or b)`
    events: ($) => choice(list($.call, keyword($, "or")), seq("(", list($.call, keyword($, "or")), ")")),

    _within: ($) => seq(keyword($, "within"), field("within", $.expression)),

    // ── Agents ──

    agent_declaration: ($) =>
      seq(
        keyword($, "agent"),
        field("name", $.identifier),
        optional(field("parameters", $.parameters)),
        keyword($, "plays"),
        field("plays", $.identifier),
        optional(seq("[", field("annotation", $.identifier), "]")),
        field("body", $.agent_body),
      ),
    agent_body: ($) => block($, choice($.belief, $.belief_rule, $.goal_type, $.goal, $.plan, $.allow)),
    belief: ($) =>
      seq(
        keyword($, "belief"),
        field("name", $.identifier),
        optional(field("parameters", $.parameters)),
        optional(seq("[", list(field("annotation", $.parameter)), "]")),
        optional(seq(keyword($, "on"), field("event", $.identifier))),
        optional(seq("=", list(seq(optional("~"), field("initial", $.call), optional($.annotations))))),
      ),
    belief_rule: ($) =>
      seq(
        keyword($, "rule"),
        optional("~"),
        field("head", $.call),
        optional($.annotations),
        optional(seq(keyword($, "when"), field("condition", $.expression))),
      ),
    goal_type: ($) =>
      seq(keyword($, "goal"), field("name", $.identifier), optional(field("parameters", $.parameters))),
    goal: ($) => seq(keyword($, "goal"), "!", field("goal", $.call)),
    plan: ($) =>
      seq(
        keyword($, "plan"),
        optional(seq("@", field("label", $.identifier), optional(seq("[", field("mode", $.identifier), "]")))),
        field("trigger", $.trigger),
        optional(seq(keyword($, "when"), field("condition", $.expression))),
        field("body", $.plan_body),
      ),
    trigger: ($) =>
      seq(field("kind", $.trigger_kind), optional("~"), field("call", $.call), optional($.annotations)),
    trigger_kind: ($) =>
      choice("+", "-", seq("+", "!"), seq("-", "!"), seq("+", "?"), seq("-", "?"), keyword($, "on")),
    // After a step that ends with a block, the semicolon may be left out.
    plan_body: ($) =>
      seq(
        "{",
        repeat(choice(seq($._plan_step, ";"), seq($._block_step, optional(";")))),
        optional($._plan_step),
        closing($),
      ),
    _block_step: ($) => choice(alias($._plan_if, $.if_step), $.while_step, $.for_step, $.fork_step),
    _plan_if: ($) =>
      seq(
        keyword($, "if"),
        field("condition", $.expression),
        field("consequence", $.plan_body),
        optional(
          seq(keyword($, "else"), field("alternative", choice($.plan_body, alias($._plan_if, $.if_step)))),
        ),
      ),
    while_step: ($) =>
      seq(keyword($, "while"), field("condition", $.expression), field("body", $.plan_body)),
    for_step: ($) => seq(keyword($, "for"), field("condition", $.expression), field("body", $.plan_body)),
    fork_step: ($) =>
      seq(
        keyword($, "fork"),
        field("branch", $.plan_body),
        choice(
          repeat1(seq(keyword($, "and"), field("branch", $.plan_body))),
          repeat1(seq(keyword($, "or"), field("branch", $.plan_body))),
        ),
      ),
    _plan_step: ($) =>
      choice(
        $.do_step,
        $.achieve_step,
        $.spawn_step,
        $.query_step,
        $.test_step,
        $.unify_step,
        $.internal_action,
        $.add_step,
        $.remove_step,
        $.replace_step,
        $.await_step,
        $.wait_step,
      ),
    do_step: ($) => $.call,
    achieve_step: ($) => seq("!", $.call, optional($._within)),
    spawn_step: ($) => seq("!!", $.call),
    query_step: ($) => seq("?", $._literal),
    test_step: ($) => seq("?", "(", field("condition", $.expression), ")"),
    unify_step: ($) => seq(field("left", $.identifier), "=", field("right", $.expression)),
    add_step: ($) => seq("+", $._literal),
    remove_step: ($) => seq("-", $._literal),
    replace_step: ($) => seq("-+", $._literal),
    _literal: ($) => seq(optional("~"), $.call, optional($.annotations)),
    await_step: ($) => seq(keyword($, "await"), field("events", $.await_events), optional($._within)),
    wait_step: ($) => seq(keyword($, "wait"), field("time", $.expression)),

    // ── Automata ──

    var_declaration: ($) =>
      seq(
        keyword($, "var"),
        field("name", $.identifier),
        ":",
        field("type", $.type),
        optional(seq("=", field("value", $.expression))),
      ),

    automaton_declaration: ($) =>
      seq(
        keyword($, "automaton"),
        field("name", $.identifier),
        optional(field("parameters", $.parameters)),
        optional(seq(keyword($, "plays"), field("plays", $.identifier))),
        field("body", $.automaton_body),
      ),
    automaton_body: ($) =>
      block($, choice($.clock, $.var_declaration, $.location, $.edge, $.function_declaration, $.allow)),
    clock: ($) => seq(keyword($, "clock"), list(field("name", $.identifier))),
    location: ($) =>
      seq(
        optional(keyword($, "init")),
        optional(choice(keyword($, "urgent"), keyword($, "committed"))),
        keyword($, "location"),
        field("name", $.identifier),
        optional(field("body", $.location_body)),
      ),
    location_body: ($) =>
      seq(
        "{",
        optional(seq(keyword($, "invariant"), field("invariant", $.expression), repeat(";"))),
        closing($),
      ),
    edge: ($) =>
      seq(
        field("from", alias($._origin, $.identifier)),
        "->",
        field("to", $.identifier),
        repeat(choice($.select, $.guard, $.synchronisation)),
        optional(seq(keyword($, "do"), field("actions", $.actions))),
      ),
    select: ($) => seq(keyword($, "select"), list($.parameter)),
    guard: ($) => seq(keyword($, "when"), field("condition", $.expression)),
    synchronisation: ($) => seq(keyword($, "on"), field("event", $.call)),
    // Takes the semicolons after the last action.
    actions: ($) => prec.right(seq($._action, repeat(choice(";", seq(";", $._action))))),
    _action: ($) => choice($.call, $.assignment),
    assignment: ($) =>
      seq(
        field("left", choice($._path, $.index_expression, $.field_expression)),
        field("operator", choice("=", "+=", "-=")),
        field("right", $.expression),
      ),

    channel_declaration: ($) =>
      seq(keyword($, "channel"), list($.event_name), optional(seq(":", $._channel_kind))),
    _channel_kind: ($) =>
      choice(
        keyword($, "urgent"),
        seq(optional(keyword($, "urgent")), keyword($, "broadcast")),
        seq(optional(keyword($, "urgent")), keyword($, "joint"), list($.participant, "|")),
      ),
    participant: ($) => seq(field("automaton", $.identifier), optional("?")),

    // The statements of a function are separated as the steps of a plan are.
    function_declaration: ($) =>
      seq(
        keyword($, "fn"),
        field("name", $.identifier),
        field("parameters", $.parameters),
        optional(seq("->", field("result", $.type))),
        field("body", $.function_body),
      ),
    function_body: ($) =>
      seq(
        "{",
        repeat(choice(seq($._statement, ";"), seq($._block_statement, optional(";")))),
        optional($._statement),
        closing($),
      ),
    _statement: ($) => choice($.var_declaration, $.assignment, $.call, $.return_statement),
    return_statement: ($) => seq(keyword($, "return"), optional(field("value", $.expression))),
    _block_statement: ($) => choice($.if_statement, $.while_statement, $.for_statement),
    if_statement: ($) =>
      seq(
        keyword($, "if"),
        field("condition", $.expression),
        field("consequence", $.function_body),
        optional(seq(keyword($, "else"), field("alternative", choice($.function_body, $.if_statement)))),
      ),
    while_statement: ($) =>
      seq(keyword($, "while"), field("condition", $.expression), field("body", $.function_body)),
    for_statement: ($) =>
      seq(
        keyword($, "for"),
        field("name", $.identifier),
        keyword($, "in"),
        field("range", $.range),
        field("body", $.function_body),
      ),

    query_declaration: ($) =>
      seq(
        keyword($, "query"),
        field("name", $.identifier),
        optional(field("title", $.string)),
        keyword($, "of"),
        field("network", $.identifier),
        "=",
        $._ask,
      ),
    _ask: ($) => choice($.quantified, $.leads_to, $.bound),
    quantified: ($) => seq(field("quantifier", $.quantifier), field("formula", $.expression)),
    leads_to: ($) => seq(field("left", $.expression), "-->", field("right", $.expression)),
    bound: ($) =>
      seq(
        choice(keyword($, "sup"), keyword($, "inf")),
        optional(seq("{", field("condition", $.expression), closing($))),
        ":",
        list(field("of", $.expression)),
      ),

    network_declaration: ($) =>
      seq(keyword($, "network"), field("name", $.identifier), "=", list(field("automaton", $.identifier), "|")),

    // ── Requirements ──

    require_declaration: ($) =>
      seq(
        keyword($, "require"),
        field("name", $.identifier),
        optional(field("parameters", $.parameters)),
        field("kind", $.identifier),
        optional(field("title", $.string)),
        field("pattern", $._pattern),
        optional(field("scope", $._scope)),
      ),
    _pattern: ($) =>
      choice(
        $.after_pattern,
        $.causes_pattern,
        $.forbids_pattern,
        $.precedes_pattern,
        $.never_pattern,
        $.globally_pattern,
        $.eventually_pattern,
        $.count_pattern,
        $.duration_pattern,
        $.formula_pattern,
      ),
    after_pattern: ($) =>
      seq(
        keyword($, "after"),
        field("trigger", $.events),
        ":",
        field("response", $.events),
        optional($._not_before),
        optional($._within),
      ),
    causes_pattern: ($) =>
      seq(
        field("trigger", $.events),
        keyword($, "causes"),
        field("response", $.events),
        optional($._not_before),
        optional($._within),
      ),
    forbids_pattern: ($) =>
      seq(
        field("trigger", $.events),
        keyword($, "forbids"),
        field("forbidden", $.events),
        keyword($, "until"),
        field("until", $.events),
      ),
    precedes_pattern: ($) =>
      seq(
        field("first", $.events),
        keyword($, "precedes"),
        field("then", $.events),
        optional($._not_before),
        optional($._within),
      ),
    // Its own `while` comes before its scope.
    never_pattern: ($) =>
      prec.right(
        seq(
          keyword($, "never"),
          field("events", $.events),
          optional(seq(keyword($, "while"), field("condition", $.expression))),
        ),
      ),
    globally_pattern: ($) =>
      seq(choice(keyword($, "globally"), keyword($, "always")), field("condition", $.expression)),
    eventually_pattern: ($) =>
      seq(keyword($, "eventually"), field("condition", $.expression), optional($._within)),
    count_pattern: ($) =>
      seq(
        choice(
          seq(keyword($, "at"), choice(keyword($, "most"), keyword($, "least"))),
          keyword($, "exactly"),
        ),
        field("count", choice($.integer, $.identifier)),
        field("events", $.events),
      ),
    duration_pattern: ($) =>
      seq(
        keyword($, "whenever"),
        field("condition", $.expression),
        keyword($, "for"),
        keyword($, "at"),
        choice(keyword($, "most"), keyword($, "least")),
        field("time", $.expression),
      ),

    // In metric temporal logic. What is in parentheses may be a number or a formula, so that there is one rule for both.
    formula_pattern: ($) => seq(keyword($, "formula"), field("formula", $._formula)),
    _formula: ($) =>
      choice(
        $.formula_junction,
        $.reach_formula,
        $.look_formula,
        $.negated_formula,
        alias($._formula_binary, $.binary_expression),
        alias($._formula_minus, $.unary_expression),
        alias($._formula_group, $.parenthesized_expression),
        $.integer,
        $.float,
        $.quantity,
        $.boolean,
        $.identifier,
        $.path,
        $.call_expression,
        $.if_expression,
      ),
    formula_junction: ($) =>
      choice(
        prec.right(
          PREC.IMPLY,
          seq(
            field("left", $._formula),
            field("operator", keyword($, "implies")),
            field("right", $._formula),
          ),
        ),
        prec.left(
          PREC.OR,
          seq(
            field("left", $._formula),
            field("operator", choice("||", keyword($, "or"))),
            field("right", $._formula),
          ),
        ),
        prec.left(
          PREC.AND,
          seq(
            field("left", $._formula),
            field("operator", choice("&&", keyword($, "and"))),
            field("right", $._formula),
          ),
        ),
      ),
    reach_formula: ($) =>
      prec.left(
        PREC.REACH,
        seq(
          field("left", $._formula),
          choice(keyword($, "until"), keyword($, "since")),
          optional(field("window", $.window)),
          field("right", $._formula),
        ),
      ),
    look_formula: ($) =>
      prec(
        PREC.NOT,
        seq(
          choice(
            keyword($, "always"),
            keyword($, "eventually"),
            keyword($, "historically"),
            keyword($, "once"),
          ),
          optional(field("window", $.window)),
          field("formula", $._formula),
        ),
      ),
    negated_formula: ($) =>
      prec(PREC.NOT, seq(choice(keyword($, "not"), "!", "!!"), field("formula", $._formula))),
    window: ($) => seq("[", field("from", $.expression), ",", field("to", $.expression), "]"),
    _formula_binary: ($) =>
      choice(
        ...[
          [PREC.COMPARE, ["==", "!=", "<", "<=", ">", ">="]],
          [PREC.ADD, ["+", "-"]],
          [PREC.MULTIPLY, ["*", "/", "%"]],
        ].map(([level, operators]) =>
          prec.left(
            level,
            seq(
              field("left", $._formula),
              field("operator", choice(...operators)),
              field("right", $._formula),
            ),
          ),
        ),
      ),
    _formula_minus: ($) => prec(PREC.NEGATE, seq(field("operator", "-"), field("operand", $._formula))),
    _formula_group: ($) => seq("(", $._formula, ")"),

    _not_before: ($) =>
      seq(keyword($, "not"), keyword($, "before"), field("not_before", $.expression)),

    _scope: ($) =>
      choice($.before_scope, $.after_scope, $.between_scope, $.while_scope),
    before_scope: ($) => seq(keyword($, "before"), field("until", $.events)),
    after_scope: ($) =>
      seq(
        keyword($, "after"),
        field("from", $.events),
        optional(seq(keyword($, "until"), field("until", $.events))),
      ),
    between_scope: ($) =>
      seq(
        keyword($, "between"),
        field("from", $.events),
        keyword($, "and"),
        field("until", $.events),
      ),
    while_scope: ($) => seq(keyword($, "while"), field("condition", $.expression)),

    assume_declaration: ($) =>
      seq(
        keyword($, "assume"),
        keyword($, "at"),
        keyword($, "most"),
        field("count", choice($.integer, $.identifier)),
        field("events", $.events),
        optional($._within),
      ),

    // ── Coverage ──

    cover_declaration: ($) =>
      seq(
        keyword($, "cover"),
        field("name", $.identifier),
        optional(field("parameters", $.parameters)),
        "=",
        keyword($, "count"),
        "(",
        field("count", alias($._counted, $.events)),
        ")",
        keyword($, "bins"),
        list($.bin),
      ),
    _counted: ($) => list($.call, keyword($, "or")),
    bin: ($) =>
      seq(
        field("name", $.identifier),
        "=",
        field("low", $._range_end),
        optional(seq("..", optional(field("high", $._range_end)))),
      ),

    cross_declaration: ($) =>
      seq(
        keyword($, "cross"),
        field("name", $.identifier),
        optional(field("parameters", $.parameters)),
        "=",
        list(field("point", $.identifier), "*"),
        field("body", $.cross_body),
      ),
    cross_body: ($) => block($, choice($.cross_bin, $.cross_ignore, $.allow)),
    cross_bin: ($) =>
      seq(
        keyword($, "bin"),
        field("name", $.string),
        keyword($, "when"),
        field("condition", $.expression),
      ),
    cross_ignore: ($) => seq(keyword($, "ignore"), keyword($, "when"), field("condition", $.expression)),

    // ── Suites and tests ──

    suite_declaration: ($) =>
      seq(
        keyword($, "suite"),
        field("name", $.identifier),
        keyword($, "by"),
        field("method", $._method),
        field("body", $.suite_body),
      ),
    _method: ($) => choice($.agents_method, $.search_method, $.random_method),
    agents_method: ($) => seq(keyword($, "agents"), list(field("agent", $.identifier))),
    search_method: ($) => seq(keyword($, "search"), keyword($, "of"), field("network", $.identifier)),
    random_method: ($) => keyword($, "random"),
    suite_body: ($) => block($, choice($.choose, $.setting, $.reach)),
    choose: ($) =>
      seq(
        keyword($, "choose"),
        choice(keyword($, "one"), keyword($, "any")),
        field("belief", $.identifier),
        keyword($, "of"),
        field("agent", $.identifier),
        optional(seq(keyword($, "per"), field("per", $.identifier))),
        optional(seq(keyword($, "where"), field("condition", $.expression))),
      ),
    // A word, and what it is set to.
    setting: ($) =>
      choice(
        seq(keyword($, "explore"), field("value", $.identifier), optional(field("arguments", $.arguments))),
        seq(keyword($, "stop"), keyword($, "after"), field("value", $.expression)),
        keyword($, "minimise"),
        ...["tests", "horizon", "patience", "warmup", "diverse", "boundary"].map((word) =>
          seq(keyword($, word), field("value", $.expression)),
        ),
        ...["witness", "delays"].map((word) => seq(keyword($, word), field("value", $.identifier))),
        seq(keyword($, "stimuli"), list(field("value", $.identifier))),
        seq(keyword($, "await"), field("value", $.await_events)),
        ...["length", "pause"].map((word) => seq(keyword($, word), field("value", $.range))),
      ),
    reach: ($) =>
      seq(
        keyword($, "reach"),
        choice(
          seq(
            keyword($, "each"),
            choice(
              seq(keyword($, "bin"), keyword($, "of"), field("of", $.identifier)),
              keyword($, "location"),
              keyword($, "edge"),
              keyword($, "plan"),
              keyword($, "use"),
              field("what", $.identifier),
              seq(
                field("what", $.identifier),
                keyword($, "of"),
                list(field("of", $.expression)),
                optional(seq(keyword($, "when"), field("condition", $.expression))),
              ),
              seq(field("what", $.identifier), keyword($, "by"), field("by", $.expression)),
            ),
          ),
          seq(field("what", $.identifier), keyword($, "of"), list(field("of", $.identifier))),
          seq(keyword($, "query"), list(field("query", $.identifier))),
        ),
      ),

    test_declaration: ($) => seq(keyword($, "test"), field("name", $._path), field("body", $.test_body)),
    test_body: ($) => block($, $._test_member),
    script: ($) => seq(field("actor", $.identifier), field("body", $.script_body)),
    script_body: ($) => block($, $._test_member),
    _test_member: ($) =>
      choice(alias($._test_setting, $.setting), $.script, $.stimulus_step, $.await_step, $.wait_step),
    _test_setting: ($) =>
      choice(
        seq(keyword($, "seed"), field("value", $.expression)),
        seq(keyword($, "method"), field("value", $.identifier)),
        seq(keyword($, "because"), field("value", $.string)),
        seq(keyword($, "predicts"), field("value", $.string)),
      ),
    stimulus_step: ($) =>
      seq(
        choice(
          seq(optional(keyword($, "meanwhile")), field("stimulus", $.call)),
          // A stimulus of this name.
          field("stimulus", alias($._call_of_meanwhile, $.call)),
        ),
        optional(seq(keyword($, "with"), list($.sampled))),
      ),
    _call_of_meanwhile: ($) => seq(field("name", alias(keyword($, "meanwhile"), $.identifier)), field("arguments", $.arguments)),
    sampled: ($) => seq(field("name", $.identifier), "=", field("value", $.expression)),

    // ── World and system ──

    part_declaration: ($) =>
      seq(
        keyword($, "part"),
        field("name", $.identifier),
        optional(field("parameters", $.parameters)),
        optional(seq(keyword($, "from"), field("description", $.string))),
        field("body", $.world_body),
      ),
    world_declaration: ($) => seq(keyword($, "world"), field("body", $.world_body)),
    world_body: ($) =>
      block($,
        choice(
          alias($._world_setting, $.setting),
          $.argument,
          $.start,
          $.walls,
          $.placement,
          $.body,
          $.joint,
          $.arm,
          $.gripper,
          $.base,
          $.laser,
          $.limb,
          $.figure,
          $.posture,
          $.current,
          $.signal,
          $.rule,
          $.allow,
        ),
      ),
    _world_setting: ($) =>
      choice(
        ...["step", "sample", "gravity"].map((word) => seq(keyword($, word), field("value", $.expression))),
        ...["packages", "semantics"].map((word) => seq(keyword($, word), field("value", $.string))),
      ),
    argument: ($) =>
      seq(keyword($, "argument"), field("name", $.string), "=", field("value", $.string)),
    start: ($) =>
      seq(
        keyword($, "start"),
        list(choice(field("state", $.string), seq(field("joint", $.identifier), "=", field("value", $.expression)))),
      ),
    walls: ($) =>
      seq(
        keyword($, "walls"),
        field("name", $.identifier),
        keyword($, "from"),
        field("map", $.string),
        keyword($, "height"),
        field("height", $.expression),
        keyword($, "at"),
        field("at", $.expression),
        optional(seq(keyword($, "rotated"), field("rotated", $.expression))),
      ),
    placement: ($) =>
      seq(
        keyword($, "part"),
        field("name", $.identifier),
        "=",
        field("part", $.identifier),
        optional(field("arguments", $.arguments)),
        $._place,
        optional(choice($._rotated, $._facing)),
      ),
    _place: ($) =>
      choice(
        seq(keyword($, "at"), field("at", $.expression)),
        seq(
          keyword($, "on"),
          field("on", $._path),
          optional(choice(seq(keyword($, "at"), field("at", $.expression)), $._beside)),
        ),
        $._beside,
      ),
    _beside: ($) =>
      seq(
        choice(
          ...["left", "right", "ahead"].map((word) => seq(keyword($, word), keyword($, "of"))),
          keyword($, "behind"),
        ),
        field("beside", $._path),
        keyword($, "by"),
        field("distance", $.expression),
      ),
    _rotated: ($) => seq(keyword($, "rotated"), field("rotated", $.expression)),
    _facing: ($) => seq(keyword($, "facing"), field("facing", $._path)),
    body: ($) =>
      seq(
        keyword($, "body"),
        field("name", $.identifier),
        ":",
        field("motion", $.identifier),
        field("shape", $.identifier),
        field("sizes", $.arguments),
        $._place,
        repeat(
          choice(
            $._rotated,
            $._facing,
            seq(keyword($, "mass"), field("mass", $.expression)),
            seq(keyword($, "stiffness"), field("stiffness", $.expression)),
            keyword($, "ghost"),
            keyword($, "graspable"),
          ),
        ),
      ),
    joint: ($) =>
      seq(
        keyword($, "joint"),
        field("name", $.identifier),
        ":",
        field("parent", alias($._origin, $.identifier)),
        "->",
        field("child", $.identifier),
        keyword($, "at"),
        field("at", $.expression),
        keyword($, "axis"),
        field("axis", $.expression),
        keyword($, "limits"),
        field("limits", $.range),
        optional(seq(keyword($, "effort"), field("effort", $.expression))),
        optional(seq(keyword($, "speed"), field("speed", $.expression))),
        optional(seq(keyword($, "rotor"), field("rotor", $.expression))),
        optional(seq(keyword($, "damping"), field("damping", $.expression))),
        optional(seq(keyword($, "friction"), field("friction", $.expression))),
        optional(
          seq(
            keyword($, "mimic"),
            field("mimic", $.identifier),
            optional(seq(keyword($, "times"), field("times", $.expression))),
          ),
        ),
      ),
    arm: ($) =>
      seq(
        keyword($, "arm"),
        field("name", $.identifier),
        ":",
        choice(list(field("joint", $.identifier)), seq(keyword($, "group"), field("group", $.string))),
        keyword($, "tip"),
        field("tip", $.identifier),
        keyword($, "tool"),
        field("tool", $.expression),
        keyword($, "speed"),
        field("speed", $.expression),
        optional(seq(keyword($, "contact"), field("contact", $.expression))),
        optional(seq(keyword($, "avoids"), field("avoids", $.identifier))),
        repeat($.sensing),
      ),
    gripper: ($) =>
      seq(
        keyword($, "gripper"),
        field("name", $.identifier),
        ":",
        field("palm", $.identifier),
        optional(
          seq(
            keyword($, "fingers"),
            choice(list(field("finger", $.identifier)), seq(keyword($, "group"), field("group", $.string))),
          ),
        ),
        keyword($, "tool"),
        field("tool", $.expression),
        keyword($, "reach"),
        field("reach", $.expression),
        keyword($, "delay"),
        field("delay", $.expression),
        optional(seq(keyword($, "force"), field("force", $.expression))),
      ),
    base: ($) =>
      seq(
        keyword($, "base"),
        field("name", $.identifier),
        ":",
        optional(field("motion", $.identifier)),
        field("body", $.identifier),
        keyword($, "speed"),
        field("speed", $.expression),
        optional(seq(keyword($, "sideways"), field("sideways", $.expression))),
        keyword($, "turn"),
        field("turn", $.expression),
        keyword($, "acceleration"),
        field("acceleration", $.expression),
        optional(seq(keyword($, "timeout"), field("timeout", $.expression))),
        repeat($.sensing),
      ),
    laser: ($) =>
      seq(
        keyword($, "laser"),
        field("name", $.identifier),
        ":",
        field("body", $.identifier),
        optional(
          seq(
            keyword($, "at"),
            field("at", $.expression),
            keyword($, "angles"),
            field("angles", $.range),
            keyword($, "beams"),
            field("beams", $.expression),
            keyword($, "range"),
            field("range", $.range),
            repeat($.sensing),
          ),
        ),
      ),
    sensing: ($) =>
      choice(
        seq(
          choice(...["every", "late", "noise", "drift", "dropout", "flip"].map((word) => keyword($, word))),
          list(field("value", $.expression)),
        ),
        seq(
          keyword($, "outlier"),
          field("value", $.expression),
          optional(seq(keyword($, "in"), field("range", $.range))),
        ),
      ),
    _body_chain: ($) =>
      seq(repeat1(seq(field("body", alias($._origin, $.identifier)), "->")), field("body", $.identifier)),
    limb: ($) =>
      seq(
        keyword($, "limb"),
        field("name", $.identifier),
        ":",
        $._body_chain,
        keyword($, "at"),
        list(field("pivot", $.expression)),
      ),
    figure: ($) =>
      seq(
        keyword($, "figure"),
        field("name", $.identifier),
        ":",
        $._body_chain,
        keyword($, "at"),
        field("hip", $.expression),
        keyword($, "limbs"),
        list(field("limb", $.identifier)),
        keyword($, "speed"),
        field("speed", $.expression),
        keyword($, "turn"),
        field("turn", $.expression),
        keyword($, "mass"),
        field("mass", $.expression),
      ),
    posture: ($) =>
      seq(
        keyword($, "posture"),
        field("name", $.identifier),
        ":",
        field("arm", $._path),
        keyword($, "at"),
        field("angles", $.expression),
      ),
    current: ($) =>
      seq(
        keyword($, "current"),
        field("name", $.identifier),
        keyword($, "in"),
        list(field("of", $._path)),
        keyword($, "by"),
        field("by", $._path),
      ),
    signal: ($) =>
      seq(
        keyword($, "signal"),
        field("name", $.identifier),
        ":",
        field("type", $.type),
        keyword($, "to"),
        list(field("to", $.identifier)),
        "=",
        field("value", $.expression),
        repeat($.sensing),
      ),
    rule: ($) =>
      seq(
        keyword($, "on"),
        choice(
          field("event", $.call),
          seq(field("command", $.identifier), field("device", $._path)),
        ),
        optional(seq(keyword($, "when"), field("condition", $.expression))),
        keyword($, "emit"),
        field("emits", $.call),
      ),

    // What devices can be told, and what they tell.
    device_declaration: ($) =>
      seq(keyword($, "device"), field("kind", $.identifier), field("body", $.device_body)),
    device_body: ($) => block($, choice($.command, $.state)),
    command: ($) =>
      seq(
        keyword($, "command"),
        field("name", $.identifier),
        optional(field("parameters", alias($.command_parameters, $.parameters))),
        keyword($, "do"),
        field("primitive", $.identifier),
        optional($.expectation),
      ),
    state: ($) =>
      seq(keyword($, "state"), field("name", $.identifier), keyword($, "from"), field("told", $.identifier)),
    command_parameters: ($) => seq("(", listed(seq($.parameter, optional("?"))), ")"),
    expectation: ($) =>
      seq(
        keyword($, "expect"),
        optional(keyword($, "not")),
        field("measure", $.identifier),
        keyword($, "else"),
        field("otherwise", $.string),
      ),

    system_declaration: ($) =>
      seq(
        keyword($, "system"),
        optional(seq(field("name", $.identifier), keyword($, "plays"))),
        field("actor", $.identifier),
        field("body", $.system_body),
      ),
    system_body: ($) => block($, choice(alias($._system_setting, $.setting), $.program, $.middleware)),
    _system_setting: ($) =>
      choice(
        seq(keyword($, "run"), field("value", $.string)),
        seq(keyword($, "coverage"), list(field("value", $.string))),
        ...["limit", "budget", "cpu", "wall", "memory", "output"].map((word) =>
          seq(keyword($, word), field("value", $.expression)),
        ),
        seq(keyword($, "env"), list(field("value", $.identifier))),
        keyword($, "online"),
      ),
    program: ($) => seq(keyword($, "program"), field("name", $.identifier), field("body", $.system_body)),

    // ── What is bound to a middleware ──

    middleware: ($) =>
      seq(
        field("version", choice(keyword($, "ros1"), keyword($, "ros2"))),
        field("body", $.binding_body),
      ),
    binding_body: ($) =>
      block($,
        choice(
          alias($._binding_setting, $.setting),
          $.topic,
          $.service,
          $.action,
          $.group,
          $.ros_parameter,
          $.transition,
        ),
      ),
    _binding_setting: ($) => seq(keyword($, "messages"), field("value", $.string)),
    topic: ($) =>
      seq(
        keyword($, "topic"),
        field("name", $.string),
        ":",
        field("interface", $.interface),
        choice($._topic_in, $._topic_out),
        optional(field("entries", $.entries)),
      ),
    _topic_in: ($) =>
      seq(
        field("direction", keyword($, "in")),
        optional(seq(keyword($, "at"), field("rate", $.expression))),
        optional(seq(keyword($, "from"), field("device", $._path))),
        optional(keyword($, "latched")),
      ),
    _topic_out: ($) =>
      seq(
        field("direction", keyword($, "out")),
        optional(seq(keyword($, "drives"), field("device", $._path))),
      ),
    service: ($) => seq(keyword($, "service"), $._served),
    action: ($) => seq(keyword($, "action"), $._served),
    _served: ($) =>
      seq(
        field("name", $.string),
        ":",
        field("interface", $.interface),
        optional(field("entries", $.entries)),
      ),
    group: ($) =>
      seq(
        keyword($, "group"),
        field("name", $.string),
        keyword($, "plans"),
        field("device", $._path),
        optional(seq(keyword($, "acceleration"), field("acceleration", $.expression))),
        optional(seq(keyword($, "tip"), field("tip", $.string))),
        optional(field("entries", $.entries)),
      ),
    ros_parameter: ($) =>
      seq(keyword($, "parameter"), field("name", $.string), "=", field("value", $.expression)),
    transition: ($) =>
      seq(
        keyword($, "transition"),
        field("from", $.string),
        "->",
        field("to", $.string),
        keyword($, "emit"),
        field("emits", $.call),
      ),
    // `std_msgs/Bool`, `std_msgs/msg/Bool`
    interface: ($) =>
      seq(
        optional(seq(field("package", $.identifier), "/", repeat(seq(field("kind", $.identifier), "/")))),
        field("name", $.identifier),
      ),
    entries: ($) => block($, choice($.field_entry, $.joint_entry, $.emit_entry, $.command_entry)),
    field_entry: ($) =>
      seq(
        field("field", choice($._path, $.index_expression, $.field_expression)),
        "=",
        field("value", $.expression),
        optional(seq(keyword($, "when"), field("condition", $.expression))),
      ),
    joint_entry: ($) => seq(field("part", $.string), "=", field("joint", $.identifier)),
    emit_entry: ($) =>
      seq(
        keyword($, "emit"),
        field("emits", $.call),
        optional(seq(keyword($, "when"), field("condition", $.expression))),
      ),
    command_entry: ($) =>
      seq(
        field("command", $.identifier),
        field("device", $._path),
        optional(field("arguments", $.arguments)),
        optional(seq(keyword($, "when"), field("condition", $.expression))),
      ),
  },
});
