//! Internal actions that stand where a value is due, such as `.length(L) > 2`: they are asked first.

use super::{
    super::{
        ast::{AgentSpeakLiteral, AgentSpeakTerm},
        internal::real_function,
    },
    clause::{ATOM, BindingMode, ClauseFragment, ClauseResult, ClauseTranslator},
};

impl ClauseTranslator<'_> {
    /// An internal action as a value: it is asked before what it stands in.
    pub(super) fn asked_first(&mut self, of: &AgentSpeakLiteral) -> ClauseResult<String> {
        let (action, text, hint) = match (of.functor.as_str(), of.args.as_slice()) {
            (".count", [formula]) => {
                let before = self.bound.clone();
                let text = self.formula(formula).map(|f| f.text);
                self.bound = before;
                (".count".to_owned(), text?, "Count")
            }
            (".length" | "math.length", [list]) => {
                self.no_choice(list)?;
                (".length".to_owned(), self.values(list, BindingMode::Value)?[0].clone(), "Length")
            }
            ("math.min", [list]) => (".min".to_owned(), self.value(list, BindingMode::Value)?, "Least"),
            ("math.max", [list]) => (".max".to_owned(), self.value(list, BindingMode::Value)?, "Most"),
            ("math.random", args) => return self.random(args),
            (name, [arg]) => {
                let f = real_function(name).ok_or("this is no single value")?;
                let arg = if f.is_of_list() {
                    self.value(arg, BindingMode::Value)?
                } else {
                    self.number(arg)?.text
                };
                (format!(".{}", f.name()), arg, "Number")
            }
            _ => return Err("this is no single value".into()),
        };
        let name = self.fresh(hint);
        self.first.push(format!("{action}({text}, {name})"));
        Ok(name)
    }

    /// A number from 0 up to 1, or up to another.
    fn random(&mut self, args: &[AgentSpeakTerm]) -> ClauseResult<String> {
        let most = args.first().map(|most| self.expr(most)).transpose()?;
        let name = self.fresh("Random");
        self.first.push(format!(".random({name})"));
        Ok(match most {
            None => name,
            Some(most) => format!("({name} * {})", most.at(ATOM)),
        })
    }

    /// A formula, with what it asks first.
    pub fn formula(&mut self, of: &AgentSpeakTerm) -> ClauseResult<ClauseFragment> {
        let outer = std::mem::take(&mut self.first);
        let written = self.formula_alone(of);
        let first = std::mem::replace(&mut self.first, outer);
        let written = written?;
        if first.is_empty() {
            return Ok(written);
        }
        let asked = first.into_iter().map(|text| ClauseFragment::new(text, ATOM));
        Ok(ClauseFragment::all(asked.chain([written]).collect()))
    }

    /// Where nothing can be asked first nothing may have to be.
    pub(super) fn asks_nothing_first(&mut self) -> ClauseResult<()> {
        match std::mem::take(&mut self.first).first() {
            None => Ok(()),
            Some(text) => Err(format!("`{text}` has to be asked first, and cannot be here").into()),
        }
    }
}
