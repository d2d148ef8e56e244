//! The parameters of a macro: `a b:=1 c:=^ d:=^|'x y' *block **content`.

/// One parameter.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) struct MacroParameter {
    /// With the stars of a block.
    pub name: String,
    /// `^`: a property of this name where the macro is called is taken.
    pub forwards: bool,
    /// What it is otherwise.
    pub default: Option<String>,
}

impl MacroParameter {
    pub fn is_block(&self) -> bool {
        self.name.starts_with('*')
    }
}

pub(super) fn parameters(text: &str) -> Vec<MacroParameter> {
    let mut found = Vec::new();
    let mut rest = text.trim_start();
    while !rest.is_empty() {
        let (parameter, after) = with_default(rest).unwrap_or_else(|| {
            let (name, after) = rest.split_once(char::is_whitespace).unwrap_or((rest, ""));
            (MacroParameter { name: name.to_owned(), forwards: false, default: None }, after)
        });
        found.push(parameter);
        rest = after.trim_start();
    }
    found
}

/// A parameter with `:=` or `=`, and what follows.
fn with_default(text: &str) -> Option<(MacroParameter, &str)> {
    let length =
        text.find(|c: char| c.is_whitespace() || c == ':' || c == '=').filter(|length| *length > 0)?;
    let (name, rest) = text.split_at_checked(length)?;
    let rest = rest.trim_start();
    let rest = rest.strip_prefix(":=").or_else(|| rest.strip_prefix('='))?.trim_start();
    let (forwards, rest) = match rest.strip_prefix('^') {
        Some(rest) => (true, rest.strip_prefix('|').unwrap_or(rest)),
        None => (false, rest),
    };
    let length = default_length(rest)?;
    let (default, after) = rest.split_at_checked(length)?;
    let default = Some(default).filter(|default| !default.is_empty()).map(str::to_owned);
    let ends = after.is_empty() || after.starts_with(char::is_whitespace);
    ends.then(|| (MacroParameter { name: name.to_owned(), forwards, default }, after))
}

/// How long a default is: an expression, a substitution, or words and quotes without blanks between them.
fn default_length(text: &str) -> Option<usize> {
    for (open, close) in [("${", '}'), ("$(", ')')] {
        if text.starts_with(open) {
            let length = text.find(close)? + 1;
            let ends = text.get(length..)?.chars().next().is_none_or(char::is_whitespace);
            if ends {
                return Some(length);
            }
        }
    }
    let mut quote = None;
    for (at, c) in text.char_indices() {
        match quote {
            Some(open) if c == open => quote = None,
            Some(_) => {}
            None if c == '\'' || c == '"' => quote = Some(c),
            None if c.is_whitespace() => return Some(at),
            None => {}
        }
    }
    quote.is_none().then_some(text.len())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn parameters_have_defaults_of_all_kinds() {
        let read = parameters("a b:=1 c:=^ d:=^|'x y' e=${1 + 2} f:= *g **h i:=$(arg j) k:='a'b");
        let told: Vec<String> = read
            .iter()
            .map(|p| {
                format!(
                    "{}{}{}",
                    p.name,
                    if p.forwards { "^" } else { "" },
                    p.default.as_deref().map_or(String::new(), |d| format!("={d}"))
                )
            })
            .collect();
        let expected = ["a", "b=1", "c^", "d^='x y'", "e=${1 + 2}", "f=*g", "**h", "i=$(arg j)", "k='a'b"];
        assert_eq!(told, expected);
    }
}
