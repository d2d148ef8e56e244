//! Suites: how tests are made.

use hrdsl_source::Span;
use serde::{Deserialize, Serialize};

use crate::{
    bdi::{AgentId, BeliefId, PlanContext},
    coverage::CrossId,
    event::{EventId, EventPattern},
    expr::Expr,
    monitor::RequirementId,
    ta::{AutomatonId, NetworkId, QueryFormula, QueryId},
    value::{Nanos, SECOND, Value},
};

#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Suite<E = Expr, T = String> {
    pub name: String,
    pub method: SuiteMethod<E, T>,
    #[serde(flatten)]
    pub settings: SuiteSettings,
    pub origin: Span,
}

/// What a suite may set, whatever its method.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(default)]
pub struct SuiteSettings {
    /// How many concrete tests; abstract tests that are fewer are made concrete several times, with other seeds.
    pub tests: u32,
    /// A model run (by agents) ends at this virtual time.
    pub horizon: Nanos,
    /// The bound of an `await` in a generated test whose model gives none.
    pub patience: Nanos,
    /// How long a generated test waits before its first step: for code that is not ready at once.
    pub warmup: Nanos,
}

impl Default for SuiteSettings {
    fn default() -> Self {
        Self { tests: 100, horizon: 300 * SECOND, patience: 60 * SECOND, warmup: 0 }
    }
}

#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum SuiteMethod<E = Expr, T = String> {
    /// Run a multi-agent system once for each chosen set of beliefs.
    Agents {
        players: Vec<PlayerRef>,
        choose: Vec<BeliefChoice<E>>,
        explore: ExploreMode,
        /// End when so many belief sets in a row reached nothing new.
        stop_after: Option<u32>,
        /// What the suite is to reach; without any, each plan and each bin.
        goals: Vec<ModelGoal>,
        /// Keep only the tests that are needed for what all of them reach.
        minimise: bool,
        /// `reach each bound`: tests with each pause a little shorter, and a little longer, too.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        bounds: Option<BoundaryStep>,
    },
    /// Model-check the network for each goal and take the witnesses' stimuli.
    Search {
        network: NetworkId,
        goals: Vec<SearchGoal<E, T>>,
        #[serde(default)]
        witness: WitnessKind,
        #[serde(default)]
        delays: DelayChoice,
        /// Up to how many different witnesses of each goal are kept; `None`: one, and fewer where one shows several goals.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        diverse: Option<u32>,
    },
    /// Draw stimuli, waits and pauses at random.
    Random {
        stimuli: Vec<EventId>,
        /// Waits for these are drawn as stimuli are.
        awaits: Vec<EventPattern>,
        length_lo: u32,
        length_hi: u32,
        pause_lo: Nanos,
        pause_hi: Nanos,
        /// The share of pauses that are put at a bound, of 0 to 1.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        boundary: Option<f64>,
    },
}

/// What plays an actor in a model run; an actor is played by at most one.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum PlayerRef {
    Agent(AgentId),
    Automaton(AutomatonId),
}

/// Which ground beliefs an agent starts with: one dimension (or several) of the belief space.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct BeliefChoice<E = Expr> {
    pub agent: AgentId,
    pub belief: BeliefId,
    pub how: ChoiceKind,
    /// `where F`: only sets of beliefs with which the agent has an answer of F are in the space.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub condition: Option<BeliefCondition<E>>,
}

/// What the beliefs that an agent starts with must answer.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct BeliefCondition<E = Expr> {
    pub context: PlanContext<E>,
    /// The names of its variables; [`AgentTerm::Var`](crate::bdi::AgentTerm::Var) counts in them.
    pub vars: Vec<String>,
    pub origin: Span,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum ChoiceKind {
    /// `choose one b`: exactly one ground instance
    One,
    /// `choose one b per p`: exactly one for each value of the parameter of this index
    OnePer(u16),
    /// `choose any b`: each ground instance is held or not
    Any,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum ExploreMode {
    Exhaustive,
    /// Every t values of t dimensions occur together in some test: `pairwise` with 2.
    Wise(u8),
    Random,
    /// Q-learning: what brought new plans and bins is chosen more often.
    Learn,
}

/// What a suite by agents is to reach.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum ModelGoal {
    /// `reach each bin of C`
    Bins(CrossId),
    /// `reach each plan`: selected
    Plans,
    /// `reach each context`: true once and false once
    Contexts,
    /// `reach each edge`: each goal of a plan's body by each plan for it
    Edges,
    /// `reach each message`: sent
    Messages,
    /// `reach each path`: each chain of three plans within an intention
    Paths,
}

/// What the items of agents' programs are tallied by.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum CoverItemKind {
    Selected,
    Completed,
    Failed,
    ContextTrue,
    ContextFalse,
    Applicable,
    Message,
    Edge,
    Path,
}

impl CoverItemKind {
    pub const ALL: [CoverItemKind; 9] = [
        CoverItemKind::Selected,
        CoverItemKind::Completed,
        CoverItemKind::Failed,
        CoverItemKind::ContextTrue,
        CoverItemKind::ContextFalse,
        CoverItemKind::Applicable,
        CoverItemKind::Message,
        CoverItemKind::Edge,
        CoverItemKind::Path,
    ];

    /// What stands before and after the place of an item in its name: `plan Human.leg#2 failed`.
    #[must_use]
    pub fn words(self) -> (&'static str, &'static str) {
        match self {
            CoverItemKind::Selected => ("plan ", ""),
            CoverItemKind::Completed => ("plan ", " completed"),
            CoverItemKind::Failed => ("plan ", " failed"),
            CoverItemKind::ContextTrue => ("context ", " true"),
            CoverItemKind::ContextFalse => ("context ", " false"),
            CoverItemKind::Applicable => ("applicable ", ""),
            CoverItemKind::Message => ("message ", ""),
            CoverItemKind::Edge => ("edge ", ""),
            CoverItemKind::Path => ("path ", ""),
        }
    }

    /// As the heading of a column.
    #[must_use]
    pub fn title(self) -> &'static str {
        match self {
            CoverItemKind::Selected => "plans selected",
            CoverItemKind::Completed => "completed",
            CoverItemKind::Failed => "failed",
            CoverItemKind::ContextTrue => "contexts true",
            CoverItemKind::ContextFalse => "contexts false",
            CoverItemKind::Applicable => "applicable sets",
            CoverItemKind::Message => "messages",
            CoverItemKind::Edge => "edges",
            CoverItemKind::Path => "paths",
        }
    }
}

/// How far beside a bound "just before" and "just after" are.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct BoundaryStep {
    /// As the suite says; `None`: the world's step, or a millisecond without a world.
    pub by: Option<Nanos>,
}

/// Values of several things at once, each combination of which is a goal.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct ValueCombinations<E = Expr, T = String> {
    pub how: CombinationKind,
    pub terms: Vec<CombinedTerm<E, T>>,
    /// They are met in states in which this holds; `None`: in any.
    pub when: Option<CombinationCondition<E, T>>,
}

/// Of how many terms the values occur together.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum CombinationKind {
    /// `each value of`: each by itself
    Value,
    /// `each pair of`: any two
    Pair,
    /// `each combination of`: all
    All,
}

/// Something with few values.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct CombinedTerm<E = Expr, T = String> {
    /// As written in the source; for the checker, where that stands.
    pub text: T,
    /// Over the network's slots, as in a [`QueryFormula`].
    pub value: E,
    pub values: Vec<Value>,
}

#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct CombinationCondition<E = Expr, T = String> {
    /// As written in the source; for the checker, where that stands.
    pub text: T,
    pub formula: QueryFormula<E>,
}

impl<E, T> ValueCombinations<E, T> {
    /// The places of the terms whose values occur together, for each choice of such terms.
    #[must_use]
    pub fn chosen(&self) -> Vec<Vec<usize>> {
        let count = self.terms.len();
        match self.how {
            CombinationKind::Value => (0..count).map(|i| vec![i]).collect(),
            CombinationKind::Pair => {
                (0..count).flat_map(|i| (i + 1..count).map(move |j| vec![i, j])).collect()
            }
            CombinationKind::All => vec![(0..count).collect()],
        }
    }

    /// How many goals they are.
    #[must_use]
    pub fn count(&self) -> usize {
        let values = |chosen: &Vec<usize>| {
            chosen.iter().fold(1usize, |n, i| n.saturating_mul(self.terms[*i].values.len()))
        };
        self.chosen().iter().map(values).fold(0, usize::saturating_add)
    }
}

#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum SearchGoal<E = Expr, T = String> {
    /// `reach each bin of C`
    Bins(CrossId),
    /// `reach each location`
    Locations,
    /// `reach each edge`
    Edges,
    /// `reach each pair`, an edge pair: two edges of one automaton, one after the other
    Pairs,
    /// `reach each use`, a def-use pair: an edge that assigns a variable, and one that reads it with no assignment between
    Uses,
    /// `reach each value`: of each variable of few values
    Values,
    /// `reach each value of a, b`, `reach each pair of …`, `reach each combination of … when F`
    Combinations(ValueCombinations<E, T>),
    /// `reach each bound`: a stimulus just before, at and just after each bound of a clock
    Bounds(BoundaryStep),
    /// `reach violation of R`
    Violation(RequirementId),
    /// `reach trigger of R`
    Trigger(RequirementId),
    /// `reach query q`, of one that asks `E<>`
    Query(QueryId),
}

/// Which witness of a goal is taken.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum WitnessKind {
    /// The first that is found.
    Any,
    /// One with as few transitions as any.
    #[default]
    Shortest,
    /// One that ends as early as any.
    Fastest,
}

/// When the transitions of a witness happen, among the times at which they can.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum DelayChoice {
    #[default]
    Earliest,
    Latest,
    /// Drawn from the seed.
    Sampled,
}
