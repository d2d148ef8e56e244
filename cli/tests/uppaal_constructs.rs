//! Each construct of UPPAAL's models that a scenario says in another way, in a small model that answers what UPPAAL's manual makes of it.

mod support;

use std::fs;

use support::{
    hrdsl_in, stderr,
    uppaal::{NO, SMALL, SmallModel, YES},
};

#[test]
fn an_element_is_put_where_a_counter_was() {
    let model = SmallModel {
        global: "int[0,9] list[4]; int[0,4] len; int k; int low[3] = { 5, 6, 7 };\n\
            int next() { return k++; }\n\
            int up() { return ++k; }\n\
            void last() { int i = 3; while (i-- > 0) { k += 10; } k += i; }\n\
            void both() { int i = 0; int j = 2; list[i++] = low[j--]; list[i++] = low[j]; len = i; }",
        edges: &[
            ("a", "b", &[("guard", "len == 0"), ("assignment", "list[len++] = 7, list[len++] = 8")]),
            ("b", "a", &[("guard", "len == 2"), ("assignment", "k = 3, list[2] = next(), list[3] = up()")]),
            ("a", "b", &[("guard", "len == 2 && k == 5"), ("assignment", "len = 0, last(), both(), --k")]),
        ],
        ..SMALL
    };
    model.answers(&[
        ("E<> P.b && list[0] == 7 && list[1] == 8 && len == 2", YES),
        ("E<> P.a && list[2] == 3 && list[3] == 5 && k == 5", YES),
        ("E<> P.b && list[0] == 7 && list[1] == 6 && k == 33 && len == 2", YES),
        ("E<> list[2] == 4", NO),
    ]);
}

#[test]
fn records_are_their_fields() {
    let model = SmallModel {
        global: "typedef struct { int[0,9] n; bool on; int[0,9] of[2]; } part;\n\
            typedef struct { part p; int[0,9] extra; } whole;\n\
            const struct { int[0,9] lo; int[0,9] hi; } limits[2] = { { 1, 5 }, { lo: 2, hi: 6 } };\n\
            whole w = { { 1, true, { 2, 3 } }, 4 }; whole parts[2]; struct { int[0,9] x, y; } at, to = { 3, 3 };\n\
            int total(const part &p) { int t = p.of[0] + p.of[1]; if (p.on) t += p.n; return t; }\n\
            typedef struct { int[0,9] x; int[0,9] y; } point;\n\
            int reach(point p) { p.x = p.x + 1; return p.x + p.y; }\n\
            point here = { 1, 2 };\n\
            void clear(part &p) { p.n = 0; p.on = false; for (i : int[0,1]) p.of[i] = 0; }",
        edges: &[
            (
                "a",
                "b",
                &[("guard", "total(w.p) == 6"), ("assignment", "parts[1] = w, clear(w.p), parts[0].p.n = 9")],
            ),
            (
                "b",
                "a",
                &[
                    ("select", "i : int[0,1]"),
                    ("guard", "parts[i].p.n < limits[i].hi && to.x == 3"),
                    ("assignment", "at = to, w.extra = reach(here)"),
                ],
            ),
        ],
        ..SMALL
    };
    model.answers(&[
        ("E<> P.b && parts[1].p.of[1] == 3 && parts[1].extra == 4 && !w.p.on && w.p.of[0] == 0", YES),
        ("E<> P.b && parts[0].p.n == 9 && at == to", NO),
        ("E<> P.a && at == to && w.extra == 4 && here.x == 1", YES),
        ("A[] at != to imply parts[0].extra == 0", YES),
        ("A[] limits[0].lo == 1 && limits[1].hi == 6", YES),
    ]);
}

#[test]
fn bits_are_those_of_uppaal() {
    // In two's complement, of 32 bits.
    let numbers: [(i32, i32); 6] = [(12, 10), (-7, 3), (-12, -10), (255, -1), (0, 0), (-32768, 32767)];
    let model = SmallModel {
        global: "int x, y; int r[6]; int[0,255] flags = 5;\n\
            void all() { r[0] = x & y; r[1] = x | y; r[2] = x ^ y; r[3] = x >> 2; r[4] = (x >> 8) << 3; \
            r[5] = (y & 7) << (x & 3); }",
        edges: &[
            ("a", "b", &[("select", "i : int[0,5]"), ("assignment", "take(i), all()")]),
            (
                "b",
                "b",
                &[
                    ("guard", "flags & 4 && !(flags & 2)"),
                    ("assignment", "flags |= 1 << 4, flags &= 250, flags ^= 3, flags <<= 1"),
                ],
            ),
        ],
        ..SMALL
    };
    let given = numbers.map(|(x, y)| format!("{{ {x}, {y} }}")).join(", ");
    let global = format!(
        "{} const int T[6][2] = {{ {given} }}; void take(int i) {{ x = T[i][0]; y = T[i][1]; }}",
        model.global
    );
    let model = SmallModel { global: global.leak(), ..model };
    let mut asked: Vec<(String, &str)> = Vec::new();
    for (x, y) in numbers {
        let r = [x & y, x | y, x ^ y, x >> 2, (x >> 8) << 3, (y & 7) << (x & 3)];
        let shown: Vec<String> = r.iter().enumerate().map(|(i, n)| format!("r[{i}] == {n}")).collect();
        asked.push((format!("A[] P.b && x == {x} && y == {y} imply {}", shown.join(" && ")), YES));
        asked.push((format!("E<> P.b && x == {x} && y == {y}"), YES));
    }
    asked.push(("E<> flags == 38".to_owned(), YES));
    asked.push(("A[] flags == 5 || flags == 38".to_owned(), YES));
    asked.push(("E<> (flags & 32) > 0 && flags >> 3 == 4 && 6 ^ 3 == 5 | 1 << 3".to_owned(), YES));
    let asked: Vec<(&str, &str)> = asked.iter().map(|(q, a)| (q.as_str(), *a)).collect();
    model.answers(&asked);
}

#[test]
fn limits_and_amounts_are_known() {
    let model = SmallModel {
        global: "int16_t n = INT16_MAX; int8_t small = -3; uint8_t byte = UINT8_MAX; scalar[3] who; meta int m;",
        edges: &[(
            "a",
            "b",
            &[
                ("guard", "abs(small) == 3"),
                ("assignment", "m = n - 1, n = abs(small - 4) + m - INT16_MAX, who = 2"),
            ],
        )],
        ..SMALL
    };
    model.answers(&[
        ("A[] P.a imply n == 32767 && byte == 255", YES),
        ("E<> P.b && n == 6 && abs(n - 10) == 4", YES),
        ("E<> P.b && n != INT8_MIN + 134", NO),
    ]);
    assert!(!model.notes().contains("meta"), "{}", model.notes());
    let across = SmallModel { edges: &[("a", "b", &[("guard", "m > 0")])], ..model };
    let notes = across.notes();
    assert!(notes.contains("small.xml:6:67: warning: the `meta` variable `m` is read"), "{notes}");
}

#[test]
fn clocks_are_chosen_by_variables() {
    let model = SmallModel {
        global: "clock x[3]; typedef struct { clock c; int[0,9] n; } timer; timer t[2]; int[0,2] k;",
        edges: &[
            (
                "a",
                "a",
                &[
                    ("select", "i : int[0,2]"),
                    ("guard", "x[i] >= 4 && k < 2"),
                    ("assignment", "x[i] = 0, k++"),
                ],
            ),
            (
                "a",
                "b",
                &[
                    ("guard", "x[k] >= 7 && t[k - 1].c > 3"),
                    ("assignment", "x[k] = 2, t[k - 1].c = 1, t[k - 1].n = k"),
                ],
            ),
        ],
        ..SMALL
    };
    model.answers(&[
        ("E<> P.a && x[0] == 0 && x[1] >= 4", YES),
        ("E<> P.a && x[0] == 0 && x[1] == 0 && k == 1", NO),
        ("E<> P.a && x[0] == 0 && x[1] == 0 && k == 2", YES),
        ("A[] P.b imply x[k] >= 2 && t[k - 1].n == k", YES),
        ("E<> P.b && k == 1 && x[1] == 2 && t[0].c == 1", YES),
        ("E<> P.b && k == 2 && x[2] == 2 && t[1].c == 1 && x[1] < 9", YES),
        ("E<> P.b && k == 2 && x[1] < 1 && t[1].c < 1", NO),
    ]);
}

#[test]
fn functions_set_clocks() {
    let model = SmallModel {
        global: "typedef int[0,2] id; clock x[id], y, z; int[0,9] n;\n\
            void all() { int i; for (i = 0; i < 3; i++) x[i] = i; y = 0; n++; }\n\
            void one(id i, clock &c) { x[i] = 5; if (n > 1) { c = 3; n = 0; return; } c = 1; }\n\
            void two() { for (i : id) if (i != 1) { one(i, y); } }",
        edges: &[
            ("a", "b", &[("guard", "z >= 7"), ("assignment", "all()")]),
            ("b", "a", &[("guard", "z >= 8 && n == 1"), ("assignment", "one(2, z)")]),
            ("b", "a", &[("guard", "z >= 20"), ("assignment", "n = 3"), ("select", "j : id")]),
            ("a", "a", &[("guard", "n == 3 && z < 100"), ("assignment", "one(0, z)")]),
        ],
        ..SMALL
    };
    model.answers(&[
        ("E<> P.b && x[0] == 0 && x[1] == 1 && x[2] == 2 && y == 0 && z > 6 && n == 1", YES),
        ("E<> P.b && x[0] == 0 && x[1] < 1", NO),
        ("E<> P.a && x[2] == 5 && z == 1 && n == 1", YES),
        ("E<> P.a && x[0] == 5 && z == 3 && n == 0", YES),
        ("E<> P.a && x[0] == 5 && z == 1 && x[1] < 1", NO),
    ]);
    let twice = SmallModel { edges: &[("a", "b", &[("assignment", "n = 2, one(0, y)")])], ..model };
    assert!(twice.refused().contains("`n`, which the same transition has changed"), "{}", twice.refused());
    let heard = SmallModel {
        global: "chan c; clock x[2]; int[0,1] n;",
        edges: &[
            ("a", "b", &[("synchronisation", "c!"), ("assignment", "n = 1")]),
            ("a", "b", &[("synchronisation", "c?"), ("assignment", "x[n] = 0")]),
        ],
        ..SMALL
    };
    assert!(heard.refused().contains("the shared variable `n`, which whoever offers"), "{}", heard.refused());
    // A reference through which nothing is assigned is shared all the same.
    let through = SmallModel {
        global: "chan c; clock x[2]; int[0,1] k;",
        parameters: "const int[0,1] &n",
        edges: &[
            ("a", "b", &[("synchronisation", "c!"), ("assignment", "k = 1")]),
            ("a", "b", &[("synchronisation", "c?"), ("assignment", "x[n] = 0")]),
        ],
        system: "Q = P(k); system Q;",
        ..SMALL
    };
    assert!(
        through.refused().contains("the shared variable `n`, which whoever offers"),
        "{}",
        through.refused()
    );
}

#[test]
fn clocks_stand_where_their_value_is_known() {
    let model = SmallModel {
        global: "clock t;",
        local: "clock x, y;",
        at_a: &[("invariant", "x' == 0 && t <= 9 && y' == 0 && x <= 3")],
        edges: &[
            ("a", "b", &[("guard", "x == 0 && t >= 5"), ("assignment", "y = 1")]),
            ("b", "a", &[("guard", "x >= 2 && y >= 3 && t <= 8"), ("assignment", "x = 3")]),
            ("a", "a", &[("guard", "x > 2 && t > 8"), ("assignment", "x = 0, t = 0")]),
        ],
        ..SMALL
    };
    // Two ways lead to `a` with different values: x stands still there in the scenario, too.
    model.answers(&[
        ("E<> P.b && P.x == 0 && t == 5", YES),
        // It comes back at 7 at the earliest, and is 3 from then on.
        ("E<> P.a && P.x == 3 && t == 7", YES),
        ("E<> P.a && P.x == 3 && t == 9", YES),
        ("E<> P.a && P.x == 3 && t < 7 && t > 1", NO),
        ("E<> P.a && P.x > 0 && P.x < 3", NO),
        ("A[] P.a imply P.x <= 3", YES),
    ]);
    let model = SmallModel {
        edges: &[
            ("a", "b", &[("guard", "x == 0 && t >= 5"), ("assignment", "y = 1")]),
            ("b", "a", &[("guard", "x >= 2 && y >= 3 && t <= 8"), ("assignment", "x = 0")]),
        ],
        ..model
    };
    model.answers(&[
        ("E<> P.b && t == 5", YES),
        ("E<> P.b && t < 5", NO),
        // x has run since `b` alone: it is 2 at 7 at the earliest.
        ("E<> P.a && t == 7", YES),
        ("sup{P.a}: t", "9 s"),
    ]);
    assert!(model.notes().contains("info: `y` may run on here"), "{}", model.notes());
    let preemptive = SmallModel {
        at_a: &[("invariant", "x' == n && x <= 3")],
        global: "int[0,1] n;",
        edges: &[("a", "b", &[("guard", "x == 3")])],
        ..model
    };
    assert!(
        preemptive.refused().contains("a location of its own, with `x' == 0`"),
        "{}",
        preemptive.refused()
    );
    let asked = SmallModel { at_a: &[("invariant", "x' == 0")], edges: &[("a", "b", &[])], ..SMALL };
    let folder = tempfile::tempdir().unwrap();
    fs::write(
        folder.path().join("small.xml"),
        SmallModel { local: "clock x;", ..asked }.xml(&["E<> P.a && P.x > 0"]),
    )
    .unwrap();
    let out = hrdsl_in(folder.path(), "import uppaal small.xml -o there.hri");
    assert!(
        stderr(&out).contains("left out: the query `E<> P.a && P.x > 0`: `P.x` is stopped"),
        "{}",
        stderr(&out)
    );
}

#[test]
fn references_are_given_with_their_indices() {
    let model = SmallModel {
        global: "typedef struct { int[0,9] n; int[0,9] of[2]; } part; part parts[3]; int[0,9] v[2][3]; int[0,2] k = 1;\n\
            void up(int &n, int[0,9] by) { n += by; k = 0; n++; }\n\
            void fill(part &p, const int[0,9] &from) { p.n = from; for (i : int[0,1]) p.of[i] = from + i; }\n\
            void all() { for (i : int[0,2]) fill(parts[i], v[1][i]); }\n\
            clock x; void late(int &n) { x = 0; n = 7; }",
        edges: &[
            // The index is that of the call, also where the function changes it.
            ("a", "b", &[("guard", "k == 1"), ("assignment", "up(v[k][k + 1], k + 1), v[1][1] = 5")]),
            (
                "b",
                "a",
                &[("guard", "x > 3"), ("assignment", "all(), fill(parts[k], v[k][k]), late(v[0][k + 2])")],
            ),
        ],
        ..SMALL
    };
    model.answers(&[
        ("E<> P.b && v[1][2] == 3 && v[1][1] == 5 && k == 0", YES),
        ("E<> P.b && v[0][1] > 0", NO),
        ("E<> P.a && parts[2].n == 3 && parts[2].of[1] == 4 && parts[1].n == 5 && parts[0].of[1] == 1", YES),
        ("E<> P.a && v[0][2] == 7 && x == 0", YES),
        ("E<> v[0][0] > 0", NO),
    ]);
}

#[test]
fn records_belong_to_processes_and_are_given_to_templates() {
    let model = SmallModel {
        global: "typedef struct { int[0,20] period; bool urgent_one; } task; const task tasks[2] = { { 5, true }, { 9, false } };\n\
            task shared; progress { shared.period; } gantt { G: shared.urgent_one -> 1; }\n\
            typedef scalar[3] who; who last;",
        parameters: "const task t, task &out, const int[0,1] id",
        local: "struct { task of; int[0,9] count; } mine = { { 1, false }, 2 }; clock x;",
        at_a: &[("invariant", "x <= t.period")],
        edges: &[
            (
                "a",
                "b",
                &[
                    ("select", "w : who"),
                    ("guard", "x == t.period"),
                    ("assignment", "out = t, mine.of = t, mine.count++, last = w"),
                ],
            ),
            (
                "b",
                "a",
                &[
                    ("guard", "mine.of == t && mine.count < 9 && x < 30 && x > t.period"),
                    ("assignment", "x = 0"),
                ],
            ),
        ],
        system: "P1 = P(tasks[0], shared, 0); P2 = P(tasks[1], shared, 1); system P1, P2;",
    };
    model.answers(&[
        ("E<> P1.mine.count == 3 && P1.mine.of.period == 5 && P2.mine.of.period == 1", YES),
        ("A[] P2.b imply P2.mine.of.period == 9 && !P2.mine.of.urgent_one", YES),
        ("E<> shared.period == 9 && shared.urgent_one", NO),
        ("sup{P1.a}: P1.x", "5 s"),
        ("sup: P2.mine.count", "9"),
        ("E<> last == 2", YES),
    ]);
    let notes = model.notes();
    assert!(notes.contains("left out: `progress`") && notes.contains("left out: `gantt`"), "{notes}");
}
