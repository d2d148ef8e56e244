//! What is in the way of an import, and where.

use hrdsl_source::Span;

/// Something that cannot be read, or not be said in a scenario.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) struct UppaalFault {
    pub span: Span,
    pub message: String,
}

impl UppaalFault {
    /// Whether it says that there is nothing of this name.
    pub fn misses(&self, name: &str) -> bool {
        let said = self.message.strip_prefix("there is no ");
        let what = said.map(|s| s.trim_start_matches("function ").trim_start_matches("type "));
        let named = what.and_then(|what| what.strip_prefix('`')?.split_once('`'));
        named.is_some_and(|(missing, rest)| missing == name && matches!(rest, "" | " here"))
    }
}

/// It ends what is being done.
pub fn fault<T>(span: Span, message: impl Into<String>) -> Result<T, UppaalFault> {
    Err(UppaalFault { span, message: message.into() })
}

/// What no scenario has, by its name.
pub fn unsupported(span: Span, what: &str) -> UppaalFault {
    UppaalFault {
        span,
        message: format!("{what} are not supported: a scenario has nothing that means the same"),
    }
}
