//! All agents and their programs: what every step after reading starts from.

use hrdsl_source::{SourceFiles, Span};

use super::{
    ast::{AgentSpeakLiteral, AgentSpeakProgram},
    parse::place,
};

/// One agent of the system.
#[derive(Debug)]
pub(crate) struct AgentSpeakAgent {
    pub name: String,
    /// Index into [`AgentSpeakSystem::programs`].
    pub program: usize,
    /// What the project gives it besides its program.
    pub beliefs: Vec<AgentSpeakLiteral>,
    pub goals: Vec<AgentSpeakLiteral>,
}

/// All agents and their programs.
#[derive(Debug, Default)]
pub(crate) struct AgentSpeakSystem {
    pub name: String,
    pub files: SourceFiles,
    pub programs: Vec<AgentSpeakProgram>,
    pub agents: Vec<AgentSpeakAgent>,
    pub skipped: Vec<(Span, String)>,
}

impl AgentSpeakSystem {
    /// The comment at the place of something that is left out, with its text.
    pub fn comment(&self, span: Span, reason: &str) -> String {
        let (file, line, _) = place(&self.files, span);
        let mut comment = format!("// not carried over: {file}:{line}: {reason}");
        for line in self.files.text(span).lines().filter(|l| !l.trim().is_empty()) {
            comment += &format!("\n//   {}", line.trim().replace('\t', " "));
        }
        comment
    }
}
