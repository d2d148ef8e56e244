//! What is in the way of an import, and where.

use hrdsl_source::Span;

/// Something that cannot be read, or not be said in a scenario.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) struct UppaalFault {
    pub span: Span,
    pub message: String,
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
