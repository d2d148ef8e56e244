//! The tree of suites.

use hrdsl_source::Span;
use serde::Serialize;

use crate::ast::{CallSyntax, ExprSyntax, NameSyntax, RangeSyntax};

/// `suite s by agents A, B { … }`, `by search of n { … }`, `by random { … }`
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct SuiteSyntax {
    pub name: NameSyntax,
    pub method: MethodSyntax,
    pub members: Vec<SuiteMember>,
}

#[derive(Clone, Debug, PartialEq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum MethodSyntax {
    /// agents and automata that play the actors
    Agents(Vec<NameSyntax>),
    Search(NameSyntax),
    Random,
}

#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct SuiteMember {
    pub kind: SuiteMemberKind,
    pub span: Span,
}

#[derive(Clone, Debug, PartialEq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum SuiteMemberKind {
    /// `choose one b of A`, `choose any b of A`, `choose one b of A per p`; `where F`, which A's beliefs must answer
    Choose {
        any: bool,
        belief: NameSyntax,
        agent: NameSyntax,
        per: Option<NameSyntax>,
        condition: Option<ExprSyntax>,
    },
    /// `explore pairwise`, `explore wise(3)`
    Explore(CallSyntax),
    /// `minimise`: only the tests that are needed for what all of them reach
    Minimise,
    /// `reach each plan`, `context`, `message`, `path`
    ReachEach(NameSyntax),
    /// `reach each value of a, b`, `reach each pair of …`, `reach each combination of … when F`
    ReachEachOf {
        what: NameSyntax,
        terms: Vec<ExprSyntax>,
        when: Option<ExprSyntax>,
    },
    /// `reach each bound by 50 ms`
    ReachEachBy {
        what: NameSyntax,
        step: ExprSyntax,
    },
    /// `tests 160`
    Setting {
        what: SuiteSetting,
        value: ExprSyntax,
    },
    /// `reach each bin of c`
    ReachBins(NameSyntax),
    /// `reach each location`
    ReachLocations,
    /// `reach each edge`
    ReachEdges,
    /// `reach violation of R1, R2`, `reach trigger of R1`
    ReachOf {
        what: NameSyntax,
        names: Vec<NameSyntax>,
    },
    /// `reach query q`
    ReachQueries(Vec<NameSyntax>),
    /// `witness shortest`
    Witness(NameSyntax),
    /// `delays earliest`
    Delays(NameSyntax),
    /// `stimuli a, b`
    Stimuli(Vec<NameSyntax>),
    /// `await a`: a wait for an event, drawn like a stimulus
    Await(Vec<CallSyntax>),
    /// `length 5..20`
    Length(RangeSyntax),
    /// `pause 0 s .. 10 s`
    Pause(RangeSyntax),
    Error,
}

/// What a suite sets to a number or a time.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum SuiteSetting {
    /// `stop after 20`: when so many belief sets in a row added nothing
    StopAfter,
    /// `tests 160`
    Tests,
    /// `horizon 300 s`: a model run ends at this virtual time
    Horizon,
    /// `patience 60 s`: the bound of an await that the model gives none
    Patience,
    /// `warmup 2 s`: before the first step of each test
    Warmup,
    /// `diverse 3`: how many different witnesses of each goal are kept
    Diverse,
    /// `boundary 0.25`: the share of pauses that are put at a bound
    Boundary,
}
