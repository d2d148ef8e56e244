//! Trees to values.

use hrdsl_source::nearest;

use super::{
    functions::{call, global, global_names, is_outer},
    methods::call_method,
    operate::{arithmetic, compare, equal},
    syntax::{XacroArithmetic, XacroExpr},
    value::{EvalResult, XacroValue, wrong},
    written::written,
};
use crate::limits::MOST_VALUE_SIZE;

/// Where names have their values.
pub(super) trait ExprNames {
    /// What the first of names that follow each other by points stands for, and how many it takes: a namespace takes two.
    fn lookup(&mut self, path: &[String]) -> EvalResult<Option<(XacroValue, usize)>>;

    /// Calls a function of xacro's own.
    fn outer(&mut self, name: &str, arguments: &[XacroValue]) -> EvalResult<XacroValue>;

    /// All names that there are.
    fn all_names(&self) -> Vec<String>;
}

pub(super) fn evaluate(expr: &XacroExpr, names: &mut dyn ExprNames) -> EvalResult<XacroValue> {
    ExprEvaluator { names, locals: Vec::new(), steps: 0 }.value(expr)
}

struct ExprEvaluator<'n> {
    names: &'n mut dyn ExprNames,
    /// The variables of `for`, the innermost last.
    locals: Vec<(String, XacroValue)>,
    steps: usize,
}

impl ExprEvaluator<'_> {
    fn value(&mut self, expr: &XacroExpr) -> EvalResult<XacroValue> {
        self.steps += 1;
        if self.steps > MOST_VALUE_SIZE {
            return wrong("it takes too many steps", "compute less");
        }
        match expr {
            XacroExpr::Value(value) => Ok(value.clone()),
            XacroExpr::Name(_) | XacroExpr::Attribute(..) => self.reference(expr),
            XacroExpr::List(items) => XacroValue::list(self.all(items)?),
            XacroExpr::Tuple(items) => XacroValue::tuple(self.all(items)?),
            XacroExpr::Dict(pairs) => self.dict(pairs),
            XacroExpr::Not(inner) => Ok(XacroValue::Bool(!self.value(inner)?.is_true())),
            XacroExpr::Negative(inner) => self.signed(inner, "-"),
            XacroExpr::Positive(inner) => self.signed(inner, "+"),
            XacroExpr::Binary(operator, a, b) => {
                let (a, b) = (self.value(a)?, self.value(b)?);
                arithmetic(*operator, &a, &b)
            }
            XacroExpr::Compare(first, others) => {
                let mut left = self.value(first)?;
                for (comparison, other) in others {
                    let right = self.value(other)?;
                    if !compare(*comparison, &left, &right)? {
                        return Ok(XacroValue::Bool(false));
                    }
                    left = right;
                }
                Ok(XacroValue::Bool(true))
            }
            XacroExpr::And(a, b) => {
                let a = self.value(a)?;
                if a.is_true() { self.value(b) } else { Ok(a) }
            }
            XacroExpr::Or(a, b) => {
                let a = self.value(a)?;
                if a.is_true() { Ok(a) } else { self.value(b) }
            }
            XacroExpr::If { condition, yes, no } => {
                if self.value(condition)?.is_true() {
                    self.value(yes)
                } else {
                    self.value(no)
                }
            }
            XacroExpr::Index(of, at) => {
                let (of, at) = (self.value(of)?, self.value(at)?);
                indexed(&of, &at)
            }
            XacroExpr::Slice(of, parts) => self.slice(of, parts),
            XacroExpr::Call(callee, arguments) => self.call(callee, arguments),
            XacroExpr::Each { item, names, over, condition } => {
                self.each(item, names, over, condition.as_deref())
            }
        }
    }

    fn all(&mut self, items: &[XacroExpr]) -> EvalResult<Vec<XacroValue>> {
        items.iter().map(|item| self.value(item)).collect()
    }

    fn dict(&mut self, pairs: &[(XacroExpr, XacroExpr)]) -> EvalResult<XacroValue> {
        let mut all: Vec<(XacroValue, XacroValue)> = Vec::new();
        for (key, value) in pairs {
            let (key, value) = (self.value(key)?, self.value(value)?);
            match all.iter_mut().find(|(k, _)| equal(k, &key)) {
                Some((_, old)) => *old = value,
                None => all.push((key, value)),
            }
        }
        XacroValue::dict(all)
    }

    fn signed(&mut self, inner: &XacroExpr, sign: &str) -> EvalResult<XacroValue> {
        let value = self.value(inner)?;
        match (sign, value.whole(), value.number()) {
            ("-", Some(_), _) => arithmetic(XacroArithmetic::Subtract, &XacroValue::Int(0), &value),
            ("-", None, Some(number)) => Ok(XacroValue::Float(-number)),
            (_, Some(number), _) => Ok(XacroValue::Int(number)),
            (_, None, Some(number)) => Ok(XacroValue::Float(number)),
            (_, None, None) => {
                wrong(format!("`{sign}` cannot stand before {}", value.noun()), "write a number behind it")
            }
        }
    }

    /// A name, or names with points between them.
    fn reference(&mut self, expr: &XacroExpr) -> EvalResult<XacroValue> {
        let Some(path) = path_of(expr) else {
            let XacroExpr::Attribute(of, name) = expr else { return wrong("a name is missing", "write one") };
            let of = self.value(of)?;
            return member(&of, name);
        };
        let (mut value, taken) = self.resolved(&path)?;
        for name in path.iter().skip(taken) {
            value = member(&value, name)?;
        }
        Ok(value)
    }

    fn resolved(&mut self, path: &[String]) -> EvalResult<(XacroValue, usize)> {
        let Some(first) = path.first() else { return wrong("a name is missing", "write one") };
        if let Some((_, value)) = self.locals.iter().rev().find(|(name, _)| name == first) {
            return Ok((value.clone(), 1));
        }
        if let Some(found) = self.names.lookup(path)? {
            return Ok(found);
        }
        if let Some(found) = global(path) {
            return Ok(found);
        }
        let mut names = self.names.all_names();
        names.extend(global_names().map(str::to_owned));
        let near = nearest(first, names.iter().map(String::as_str));
        let help = match near {
            Some(near) => format!("write `{near}`"),
            None => format!("declare it: `<xacro:property name=\"{first}\" value=\"…\"/>`"),
        };
        wrong(format!("nothing is called `{first}`"), help)
    }

    fn slice(&mut self, of: &XacroExpr, parts: &[Option<Box<XacroExpr>>; 3]) -> EvalResult<XacroValue> {
        let of = self.value(of)?;
        let mut bounds = [None; 3];
        for (bound, part) in bounds.iter_mut().zip(parts) {
            if let Some(part) = part {
                let value = self.value(part)?;
                *bound = value.whole();
                if bound.is_none() {
                    return wrong(format!("{} bounds no slice", value.noun()), "write whole numbers");
                }
            }
        }
        sliced(&of, bounds)
    }

    fn call(&mut self, callee: &XacroExpr, arguments: &[XacroExpr]) -> EvalResult<XacroValue> {
        if let Some(path) = path_of(callee) {
            let is_local =
                path.first().is_some_and(|first| self.locals.iter().any(|(name, _)| name == first));
            let found = if is_local { None } else { self.names.lookup(&path)?.or_else(|| global(&path)) };
            if let Some((XacroValue::Function(name), taken)) = &found
                && *taken == path.len()
            {
                let arguments = self.all(arguments)?;
                return if is_outer(name) {
                    self.names.outer(name, &arguments)
                } else {
                    call(name, &arguments)
                };
            }
        }
        if let XacroExpr::Attribute(of, name) = callee {
            let of = self.value(of)?;
            let arguments = self.all(arguments)?;
            return call_method(&of, name, &arguments);
        }
        let value = self.value(callee)?;
        wrong(format!("{} is no function", value.noun()), "take the parentheses out")
    }

    fn each(
        &mut self,
        item: &XacroExpr,
        names: &[String],
        over: &XacroExpr,
        condition: Option<&XacroExpr>,
    ) -> EvalResult<XacroValue> {
        let values = self.value(over)?.iterated()?;
        let before = self.locals.len();
        let mut found = Vec::new();
        for value in values {
            match names {
                [name] => self.locals.push((name.clone(), value)),
                names => {
                    let parts = value.iterated()?;
                    if parts.len() != names.len() {
                        return wrong(
                            format!("{} names for {} values", names.len(), parts.len()),
                            "write as many names",
                        );
                    }
                    self.locals.extend(names.iter().cloned().zip(parts));
                }
            }
            let wanted = match condition {
                Some(condition) => self.value(condition)?.is_true(),
                None => true,
            };
            if wanted {
                found.push(self.value(item)?);
            }
            self.locals.truncate(before);
        }
        XacroValue::list(found)
    }
}

/// Names with points between them, if it is nothing else.
fn path_of(expr: &XacroExpr) -> Option<Vec<String>> {
    let mut names = Vec::new();
    let mut at = expr;
    loop {
        if let XacroExpr::Attribute(of, name) = at {
            names.push(name.clone());
            at = of;
        } else if let XacroExpr::Name(name) = at {
            names.push(name.clone());
            names.reverse();
            return Some(names);
        } else {
            return None;
        }
    }
}

/// `value.name`: the key of a dictionary.
fn member(of: &XacroValue, name: &str) -> EvalResult<XacroValue> {
    if let XacroValue::Dict(_) = of {
        indexed(of, &XacroValue::text(name)?)
    } else {
        wrong(format!("{} has no `{name}`", of.noun()), "only dictionaries have keys behind a point")
    }
}

fn indexed(of: &XacroValue, at: &XacroValue) -> EvalResult<XacroValue> {
    let place = |length: usize| {
        let number = at.whole()?;
        let from_start = if number < 0 { number.checked_add(length as i64)? } else { number };
        usize::try_from(from_start).ok().filter(|at| *at < length)
    };
    let outside = |length: usize| {
        wrong(format!("`[{}]` lies outside of {length}", written(at)), "count from 0, or from -1 backwards")
    };
    match of {
        XacroValue::List(items) | XacroValue::Tuple(items) => {
            let items = items.as_slice();
            match place(items.len()).and_then(|at| items.get(at)) {
                Some(value) => Ok(value.clone()),
                None => outside(items.len()),
            }
        }
        XacroValue::Text(text) => {
            let length = text.chars().count();
            match place(length).and_then(|at| text.chars().nth(at)) {
                Some(c) => XacroValue::text(c.to_string()),
                None => outside(length),
            }
        }
        XacroValue::Dict(pairs) => match pairs.iter().find(|(key, _)| equal(key, at)) {
            Some((_, value)) => Ok(value.clone()),
            None => {
                let keys: Vec<String> = pairs.iter().map(|(key, _)| written(key)).collect();
                let near = nearest(&written(at), keys.iter().map(String::as_str));
                let help = near.map_or("look at its keys".to_owned(), |near| format!("write `{near}`"));
                wrong(format!("the dictionary has no key `{}`", written(at)), help)
            }
        },
        XacroValue::None
        | XacroValue::Bool(_)
        | XacroValue::Int(_)
        | XacroValue::Float(_)
        | XacroValue::Function(_) => {
            wrong(format!("{} has no parts", of.noun()), "index a list or a dictionary")
        }
    }
}

fn sliced(of: &XacroValue, [from, to, by]: [Option<i64>; 3]) -> EvalResult<XacroValue> {
    let by = by.unwrap_or(1);
    if by == 0 {
        return wrong("a slice has the step 0", "write another");
    }
    let values = of.iterated()?;
    let length = values.len() as i64;
    let bound = |bound: i64, least: i64, most: i64| {
        let at = if bound < 0 { bound.saturating_add(length) } else { bound };
        at.clamp(least, most)
    };
    let (start, end) = if by > 0 {
        (from.map_or(0, |f| bound(f, 0, length)), to.map_or(length, |t| bound(t, 0, length)))
    } else {
        (from.map_or(length - 1, |f| bound(f, -1, length - 1)), to.map_or(-1, |t| bound(t, -1, length - 1)))
    };
    let places = std::iter::successors(Some(start), |at| at.checked_add(by));
    let places = places.take_while(|at| if by > 0 { *at < end } else { *at > end });
    let picked: Vec<XacroValue> =
        places.filter_map(|at| values.get(usize::try_from(at).ok()?).cloned()).collect();
    match of {
        XacroValue::Text(_) => XacroValue::text(picked.iter().map(written).collect::<String>()),
        XacroValue::Tuple(_) => XacroValue::tuple(picked),
        XacroValue::None
        | XacroValue::Bool(_)
        | XacroValue::Int(_)
        | XacroValue::Float(_)
        | XacroValue::List(_)
        | XacroValue::Dict(_)
        | XacroValue::Function(_) => XacroValue::list(picked),
    }
}
