//! Templates: regular expressions with names above the line `---`, a JSON text with `{{name}}` in its strings below.

use std::collections::BTreeMap;

/// How often a definition may refer to the ones before it, one within the other.
const DEPTH: usize = 16;

/// Fills a template. `list` gives the words for names that the template does not define.
pub(crate) fn fill(
    template: &str,
    list: &dyn Fn(&str) -> Option<Vec<&'static str>>,
) -> Result<String, String> {
    let (head, body) = template.split_once("\n---\n").ok_or("there is no line `---`")?;
    let mut defined = BTreeMap::new();
    for line in head.lines().filter(|l| !l.is_empty() && !l.starts_with('#')) {
        let (name, value) = line.split_once(" = ").ok_or_else(|| format!("not a definition: `{line}`"))?;
        defined.insert(name.trim(), value.trim());
    }
    let filler = TemplateFiller { defined, list };
    filler.expand(body, 0, &json_escaped)
}

struct TemplateFiller<'t> {
    defined: BTreeMap<&'t str, &'t str>,
    list: &'t dyn Fn(&str) -> Option<Vec<&'static str>>,
}

impl TemplateFiller<'_> {
    /// Replaces every `{{name}}`, and passes what comes in its place through `escape`.
    fn expand(&self, text: &str, depth: usize, escape: &dyn Fn(&str) -> String) -> Result<String, String> {
        if depth > DEPTH {
            return Err(format!("definitions go in a circle, at `{text}`"));
        }
        let mut out = String::with_capacity(text.len() * 2);
        let mut rest = text;
        while let Some((before, after)) = rest.split_once("{{") {
            let (name, after) = after.split_once("}}").ok_or("`{{` without `}}`")?;
            out.push_str(before);
            out.push_str(&escape(&self.value(name, depth)?));
            rest = after;
        }
        out.push_str(rest);
        Ok(out)
    }

    fn value(&self, name: &str, depth: usize) -> Result<String, String> {
        if let Some(value) = self.defined.get(name) {
            return self.expand(value, depth + 1, &str::to_owned);
        }
        let words = (self.list)(name).ok_or_else(|| format!("there is no `{name}`"))?;
        Ok(words.join("|"))
    }
}

fn json_escaped(text: &str) -> String {
    text.replace('\\', "\\\\").replace('"', "\\\"")
}

#[cfg(test)]
mod tests {
    use super::*;

    fn words(name: &str) -> Option<Vec<&'static str>> {
        (name == "heads").then(|| vec!["agent", "test"])
    }

    #[test]
    fn definitions_and_lists_are_filled_in() {
        let text =
            "# says what it is\nhead = \\b({{heads}})\\b\nline = ^\"{{head}}\n---\n{ \"a\": \"{{line}}\" }\n";
        assert_eq!(fill(text, &words).unwrap(), "{ \"a\": \"^\\\"\\\\b(agent|test)\\\\b\" }\n");
    }

    #[test]
    fn faults_of_a_template_are_said() {
        let fault = |text: &str| fill(text, &words).unwrap_err();
        assert_eq!(fault("{}"), "there is no line `---`");
        assert_eq!(fault("a = b\n---\n{{c}}"), "there is no `c`");
        assert_eq!(fault("a = b\n---\n{{a"), "`{{` without `}}`");
        assert_eq!(fault("a\n---\n"), "not a definition: `a`");
        assert!(fault("a = {{b}}\nb = {{a}}\n---\n{{a}}").starts_with("definitions go in a circle"));
    }
}
