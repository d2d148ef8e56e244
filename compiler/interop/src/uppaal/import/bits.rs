//! Operations on bits, which a scenario has not: functions that go through them, written into it when they are first needed.

use hrdsl_source::Span;

use super::{
    ast::UppaalBinaryOperator,
    expr::fold,
    fault::UppaalFault,
    scope::{NameOwner, ScenarioExprText, ScenarioPrecedence},
    translation::UppaalTranslation,
};

/// UPPAAL's integers.
const INT: &str = "-2147483648..2147483647";

/// What they are while they are gone through.
const WIDE: &str = "-8589934592..8589934592";

impl UppaalTranslation<'_> {
    /// `a & b` and its like.
    pub fn on_bits(
        &mut self,
        op: UppaalBinaryOperator,
        a: ScenarioExprText,
        b: ScenarioExprText,
        span: Span,
    ) -> Result<ScenarioExprText, UppaalFault> {
        if let Some((a, b)) = a.value.zip(b.value) {
            return fold(op, a, b, span).map(ScenarioExprText::int);
        }
        if op == UppaalBinaryOperator::ShiftLeft
            && let Some(places @ 0..31) = b.value
        {
            let text = format!("{} * {}", a.at(ScenarioPrecedence::Product), 1_i64 << places);
            return Ok(ScenarioExprText::new(text, ScenarioPrecedence::Product, false));
        }
        let text = format!("{}({}, {})", self.bit_function(op), a.text, b.text);
        Ok(ScenarioExprText::new(text, ScenarioPrecedence::Atom, false))
    }

    /// The name of the function for an operation.
    fn bit_function(&mut self, op: UppaalBinaryOperator) -> String {
        if let Some((_, name)) = self.bit_functions.iter().find(|(of, _)| *of == op) {
            return name.clone();
        }
        let wanted = match op {
            UppaalBinaryOperator::BitAnd => "bits_and",
            UppaalBinaryOperator::BitOr => "bits_or",
            UppaalBinaryOperator::BitXor => "bits_xor",
            UppaalBinaryOperator::ShiftLeft => "shift_left",
            _ => "shift_right",
        };
        let name = self.names.unused(wanted, NameOwner::All);
        self.bit_functions.push((op, name.clone()));
        name
    }

    /// Writes those that are called, once all other names are known.
    pub fn write_bit_functions(&mut self) {
        for (op, name) in std::mem::take(&mut self.bit_functions) {
            self.names.start_process();
            self.names.start_function();
            let names = ["a", "b", "x", "y", "worth", "all", "p", "q", "i"];
            let names = names.map(|name| self.names.unused(name, NameOwner::Function));
            self.functions.push(match op {
                UppaalBinaryOperator::BitAnd => bit_by_bit(&name, &names, Some("&&")),
                UppaalBinaryOperator::BitOr => bit_by_bit(&name, &names, Some("||")),
                UppaalBinaryOperator::BitXor => bit_by_bit(&name, &names, None),
                _ => shifted(&name, &names, op == UppaalBinaryOperator::ShiftLeft),
            });
        }
    }
}

/// Bit by bit, as long as one of the numbers has others than its sign; of the rest, each is the sign.
fn bit_by_bit(name: &str, names: &[String; 9], joined: Option<&str>) -> String {
    let [a, b, x, y, worth, all, p, q, _] = names;
    let (bits, signs) = match joined {
        Some(op) => (format!("{p} == 1 {op} {q} == 1"), format!("{x} == -1 {op} {y} == -1")),
        None => (format!("{p} != {q}"), format!("{x} != {y}")),
    };
    format!(
        "fn {name}({a}: {INT}, {b}: {INT}) -> {INT} {{\n\
         var {x}: {INT} = {a};\nvar {y}: {INT} = {b};\nvar {worth}: {WIDE} = 1;\nvar {all}: {WIDE} = 0;\n\
         while {x} < -1 || {x} > 0 || {y} < -1 || {y} > 0 {{\n\
         var {p}: 0..1 = if {x} % 2 == 0 {{ 0 }} else {{ 1 }};\n\
         var {q}: 0..1 = if {y} % 2 == 0 {{ 0 }} else {{ 1 }};\n\
         if {bits} {{ {all} += {worth} }}\n\
         {x} = ({x} - {p}) / 2;\n{y} = ({y} - {q}) / 2;\n{worth} = {worth} * 2\n}}\n\
         if {signs} {{ {all} -= {worth} }}\nreturn {all}\n}}"
    )
}

/// By so many places: twice as much each time, or half of it, towards the lower number.
fn shifted(name: &str, names: &[String; 9], left: bool) -> String {
    let [a, b, .., all, _, _, i] = names;
    let step = if left {
        format!("{all} = {all} * 2")
    } else {
        format!("{all} = ({all} - if {all} % 2 == 0 {{ 0 }} else {{ 1 }}) / 2")
    };
    format!(
        "fn {name}({a}: {INT}, {b}: 0..31) -> {INT} {{\nvar {all}: {INT} = {a};\n\
         for {i} in 1..{b} {{ {step} }}\nreturn {all}\n}}"
    )
}
