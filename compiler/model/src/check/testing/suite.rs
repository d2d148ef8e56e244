//! Suites: how tests are made.

use hrdsl_ir::{Nanos, suite::SuiteSettings, value::nanos};
use hrdsl_source::Span;
use hrdsl_syntax::ast::{
    self, ItemSyntaxKind, MethodSyntax as SyntaxMethod, NameSyntax, SuiteMember, SuiteMemberKind as Member,
    SuiteSetting,
};

use super::phase::TestingPhase;
use crate::check::state::phase::CheckPhase;
use crate::check::template::CheckerPhase;
use crate::check::unread;
use crate::check::{
    agents::{agent::AgentScope, phase::AgentsPhase},
    checker::NOBODY,
    state::{issues::too_many, scope::ExprEnv, table::MAX_NAMES},
};
use crate::{
    BoundaryStep, ChoiceKind, CrossId, DelayChoice, Dimension, EventId, EventPattern, ExploreMode,
    InferredType, ModelGoal, NetworkId, PlayerRef, Role, TypedChoice, TypedChoiceCondition, TypedMethod,
    TypedSearchGoal, TypedSuite, Value, WitnessKind,
    noun::Noun,
    report::{coverage::bad_suite, names, roles, types},
};

/// What the members of a suite say, whatever its method.
#[derive(Default)]
pub(super) struct SuiteMembers {
    choose: Vec<TypedChoice>,
    explore: Option<ExploreMode>,
    pub(super) goals: Vec<TypedSearchGoal>,
    reached: Vec<ModelGoal>,
    stop_after: Option<u32>,
    minimise: bool,
    witness: WitnessKind,
    delays: DelayChoice,
    diverse: Option<u32>,
    /// `reach each bound`, of agents.
    pub(super) bounds: Option<BoundaryStep>,
    boundary: Option<f64>,
    stimuli: Vec<EventId>,
    awaits: Vec<EventPattern>,
    length: Option<(u32, u32)>,
    pause: Option<(f64, f64)>,
    settings: SuiteSettings,
}

impl SuiteMembers {
    /// In seconds; one that has a diagnostic leaves what was.
    fn set_time(&mut self, of: impl FnOnce(&mut SuiteSettings) -> &mut Nanos, time: Option<f64>) {
        if let Some(time) = time {
            *of(&mut self.settings) = nanos(time);
        }
    }
}

impl TestingPhase<'_, '_> {
    pub(in crate::check) fn suites(&mut self) {
        self.source.unread_members = self.players.agents.iter().any(|a| unread::in_agent(a.syntax));
        for (item, span) in self.each_item() {
            if let ItemSyntaxKind::Suite(suite) = item {
                let looked_at = self.source.looks_at(CheckPhase::Suites, span);
                let resolved = if looked_at { self.suite(suite, span) } else { None };
                let new = self.checker.issues.declare(&mut self.suites, Noun::Suite, &suite.name).is_some();
                self.s.suites.extend(resolved.filter(|_| new));
            }
        }
        self.source.unread_members = false;
    }

    fn suite(&mut self, suite: &ast::SuiteSyntax, span: Span) -> Option<TypedSuite> {
        let players = match &suite.method {
            SyntaxMethod::Agents(names) => self.suite_players(names),
            SyntaxMethod::Search(_) | SyntaxMethod::Random => Vec::new(),
        };
        let network = match &suite.method {
            SyntaxMethod::Search(name) => self.suite_network(name),
            SyntaxMethod::Agents(_) | SyntaxMethod::Random => None,
        };
        let mut said = SuiteMembers::default();
        for member in &suite.members {
            if self.fits_method(member, &suite.method) {
                let by_search = matches!(suite.method, SyntaxMethod::Search(_));
                self.member(member, &players, by_search, &mut said);
            }
        }
        let method = match &suite.method {
            SyntaxMethod::Agents(_) => {
                let explore = said.explore.unwrap_or(ExploreMode::Wise(2));
                let SuiteMembers { choose, reached: goals, stop_after, minimise, bounds, .. } = said;
                TypedMethod::Agents { players, choose, explore, stop_after, goals, minimise, bounds }
            }
            SyntaxMethod::Search(_) => {
                if !suite.members.iter().any(is_goal) {
                    let message = format!("the suite `{}` has nothing to reach", suite.name.text);
                    self.report(bad_suite(suite.name.span, message, "add `reach each location`"));
                }
                let SuiteMembers { goals, witness, delays, diverse, .. } = said;
                let network = self.of_network(network?, &goals, suite);
                self.bounded(network, suite);
                TypedMethod::Search { network, goals, witness, delays, diverse }
            }
            SyntaxMethod::Random => {
                if !suite.members.iter().any(|m| matches!(m.kind, Member::Stimuli(_) | Member::Error)) {
                    let message = format!("the suite `{}` has no stimuli to draw", suite.name.text);
                    self.report(bad_suite(suite.name.span, message, "add `stimuli …`"));
                }
                let (stimuli, awaits) = (said.stimuli, said.awaits);
                let (length, pause) = (said.length.unwrap_or((5, 20)), said.pause.unwrap_or((0.0, 10.0)));
                TypedMethod::Random {
                    stimuli,
                    awaits,
                    length_lo: length.0,
                    length_hi: length.1,
                    pause_lo: nanos(pause.0),
                    pause_hi: nanos(pause.1),
                    boundary: self.boundary_of(said.boundary, pause, suite),
                }
            }
        };
        Some(TypedSuite { name: suite.name.text.clone(), method, settings: said.settings, origin: span })
    }

    /// Agents and automata; at most one for an actor.
    fn suite_players(&mut self, list: &[NameSyntax]) -> Vec<PlayerRef> {
        self.unknown_player = list.iter().any(|name| self.players.table.get(&name.text).is_none());
        let mut players = Vec::new();
        let mut actors = Vec::new();
        for name in list {
            let Some(id) = self.players.table.get(&name.text) else {
                let all = self.near_of(&[Noun::Agent, Noun::Automaton]);
                self.unknown(Noun::Player, name, &all, None);
                continue;
            };
            self.refer(name, self.players.table.span(id));
            let player = self.players.ids[usize::from(id)];
            let actor = match player {
                PlayerRef::Agent(a) => Some(self.s.agents[usize::from(a.0)].actor),
                PlayerRef::Automaton(a) => self.s.automata[usize::from(a.0)].actor,
            };
            let Some(actor) = actor else {
                let message = format!("`{}` plays no actor: it cannot be a player", name.text);
                let help = format!("write `automaton {} plays ACTOR`, or name another", name.text);
                self.report(bad_suite(name.span, message, &help));
                continue;
            };
            if let Some((_, first)) = actors.iter().find(|(a, _)| *a == actor && actor != NOBODY) {
                let message = format!("`{}` plays `{}` a second time", name.text, self.actor_name(actor));
                let issue = bad_suite(name.span, message, "an actor is played by at most one");
                self.report(issue.label(*first, "this plays it already"));
                continue;
            }
            actors.push((actor, name.span));
            players.push(player);
        }
        let acts = actors.iter().any(|(a, _)| self.role_of(*a) == Role::Environment);
        if let (false, [first, ..], true) = (acts, list, players.len() == list.len()) {
            let message = "nobody here plays the environment: the tests would be empty";
            self.report(bad_suite(first.span, message, "add an agent that plays an environment actor"));
        }
        players
    }

    fn suite_network(&mut self, name: &NameSyntax) -> Option<NetworkId> {
        let found = self.networks.table.get(&name.text).map(NetworkId);
        self.refer(name, self.networks.table.span_of(&name.text));
        if found.is_none() {
            let all = self.near_of(&[Noun::Network]);
            self.unknown(Noun::Network, name, &all, None);
        }
        found
    }

    /// Some members belong to one method only.
    fn fits_method(&mut self, member: &SuiteMember, method: &SyntaxMethod) -> bool {
        let needs = match &member.kind {
            Member::Choose { .. }
            | Member::Explore(_)
            | Member::Setting { what: SuiteSetting::StopAfter | SuiteSetting::Horizon, .. }
            | Member::Minimise => "agents",
            Member::ReachEachBy { .. } if !matches!(method, SyntaxMethod::Random) => return true,
            Member::ReachEachOf { .. }
            | Member::ReachEachBy { .. }
            | Member::Setting { what: SuiteSetting::Diverse, .. } => "search",
            Member::Setting { what: SuiteSetting::Boundary, .. } => "random",
            Member::ReachEach(_) if matches!(method, SyntaxMethod::Search(_)) => return true,
            Member::ReachEach(_) => "agents",
            // Both.
            Member::ReachBins(_) | Member::ReachEdges if matches!(method, SyntaxMethod::Agents(_)) => {
                return true;
            }
            Member::ReachBins(_)
            | Member::ReachLocations
            | Member::ReachEdges
            | Member::ReachOf { .. }
            | Member::ReachQueries(_)
            | Member::Witness(_)
            | Member::Delays(_) => "search",
            Member::Stimuli(_) | Member::Await(_) | Member::Length(_) | Member::Pause(_) => "random",
            Member::Setting { .. } | Member::Error => return true,
        };
        let is = match method {
            SyntaxMethod::Agents(_) => "agents",
            SyntaxMethod::Search(_) => "search",
            SyntaxMethod::Random => "random",
        };
        if is != needs {
            let message = format!("this belongs to a suite `by {needs}`, and this one is `by {is}`");
            self.report(bad_suite(member.span, message, "remove it, or change the suite's method"));
        }
        is == needs
    }

    #[expect(clippy::too_many_lines, reason = "a flat match")]
    fn member(
        &mut self,
        member: &SuiteMember,
        players: &[PlayerRef],
        by_search: bool,
        said: &mut SuiteMembers,
    ) {
        match &member.kind {
            Member::Choose { any, belief, agent, per, condition } => {
                let choice = self.choose(*any, belief, agent, per.as_ref(), players);
                let condition = condition.as_ref().and_then(|e| self.choice_condition(agent, e));
                said.choose.extend(choice.map(|choice| TypedChoice { condition, ..choice }));
            }
            Member::Explore(call) => said.explore = self.explore(call),
            Member::Setting { what, value } => self.setting(*what, value, said),
            Member::Minimise => said.minimise = true,
            Member::ReachEach(word) if by_search => self.reach_each_of_network(word, said),
            Member::ReachEach(word) => {
                let goals = [ModelGoal::Plans, ModelGoal::Contexts, ModelGoal::Messages, ModelGoal::Paths];
                let words = ["plan", "context", "message", "path", "bound", "edge", "bin of …"];
                let found = self.choice(Noun::Reach, word, &words);
                said.reached.extend(found.and_then(|i| goals.get(i)));
                if word.text == "bound" {
                    said.bounds = Some(BoundaryStep::default());
                }
            }
            Member::ReachEachOf { .. } => {
                let found = self.networks.combinations.get(&member.span).cloned();
                said.goals.extend(found.map(TypedSearchGoal::Combinations));
            }
            Member::ReachEachBy { what, step } => self.reach_each_by(what, step, by_search, said),
            Member::ReachOf { what, names } => self.reach_of(what, names, said),
            Member::ReachQueries(names) => {
                for name in names {
                    said.goals.extend(self.reach_query(name));
                }
            }
            Member::Witness(word) => {
                let kinds = [WitnessKind::Any, WitnessKind::Shortest, WitnessKind::Fastest];
                let found = self.choice(Noun::Witness, word, &["any", "shortest", "fastest"]);
                said.witness = found.map_or(said.witness, |i| kinds[i]);
            }
            Member::Delays(word) => {
                let kinds = [DelayChoice::Earliest, DelayChoice::Latest, DelayChoice::Sampled];
                let found = self.choice(Noun::Delays, word, &["earliest", "latest", "sampled"]);
                said.delays = found.map_or(said.delays, |i| kinds[i]);
            }
            Member::ReachBins(name) => match self.crosses.get(&name.text) {
                Some(id) => {
                    self.refer(name, self.crosses.span(id));
                    said.goals.push(TypedSearchGoal::Bins(CrossId(id)));
                    said.reached.push(ModelGoal::Bins(CrossId(id)));
                }
                None => {
                    let all = self.near_of(&[Noun::Cross]);
                    self.unknown(Noun::Cross, name, &all, None);
                }
            },
            Member::ReachLocations => said.goals.push(TypedSearchGoal::Locations),
            Member::ReachEdges => {
                said.goals.push(TypedSearchGoal::Edges);
                said.reached.push(ModelGoal::Edges);
            }
            Member::Stimuli(names) => {
                for name in names {
                    said.stimuli.extend(self.test_stimulus(name));
                }
            }
            Member::Await(events) => said.awaits.extend(self.patterns(events)),
            Member::Length(range) => said.length = self.length(range),
            Member::Pause(range) => said.pause = self.pause(range),
            Member::Error => {}
        }
    }

    fn setting(&mut self, what: SuiteSetting, value: &ast::ExprSyntax, said: &mut SuiteMembers) {
        let whole = |n: Option<i64>| n.and_then(|n| u32::try_from(n).ok());
        match what {
            SuiteSetting::StopAfter => {
                said.stop_after = whole(self.count(value, "the number of sets without anything new", 1));
            }
            SuiteSetting::Tests => {
                let tests = whole(self.count(value, "the number of tests", 1));
                said.settings.tests = tests.unwrap_or(said.settings.tests);
            }
            SuiteSetting::Diverse => said.diverse = self.diverse(value),
            SuiteSetting::Boundary => said.boundary = self.share(value),
            SuiteSetting::Horizon => said.set_time(|s| &mut s.horizon, self.time(value, "the horizon", true)),
            SuiteSetting::Warmup => said.set_time(|s| &mut s.warmup, self.time(value, "the warm-up", false)),
            SuiteSetting::Patience => {
                said.set_time(|s| &mut s.patience, self.time(value, "the patience", true));
            }
        }
    }

    /// `pairwise`, `wise(3)`, …
    fn explore(&mut self, call: &ast::CallSyntax) -> Option<ExploreMode> {
        let words = ["exhaustive", "pairwise", "random", "learn", "wise"];
        let way = self.choice(Noun::Explore, &call.name, &words)?;
        let args = call.args.as_deref().unwrap_or_default();
        let ways = [ExploreMode::Exhaustive, ExploreMode::Wise(2), ExploreMode::Random, ExploreMode::Learn];
        let want = usize::from(words[way] == "wise");
        if args.len() != want {
            let issue = types::counts(Noun::Explore, words[way], want, args.len(), call.span);
            let usage = if want == 1 { "wise(3)" } else { words[way] };
            self.report(issue.help(format!("write `explore {usage}`")));
            return None;
        }
        let Some(strength) = args.first() else { return ways.get(way).copied() };
        let t = self.count(strength, "how many values occur together", 2)?;
        if t > 6 {
            self.report(types::must_be("how many values occur together", "2 to 6", strength.span));
            return None;
        }
        u8::try_from(t).ok().map(ExploreMode::Wise)
    }

    fn choose(
        &mut self,
        any: bool,
        belief: &NameSyntax,
        agent: &NameSyntax,
        per: Option<&NameSyntax>,
        players: &[PlayerRef],
    ) -> Option<TypedChoice> {
        let player = self.players.table.get(&agent.text).map(|id| self.players.ids[usize::from(id)]);
        let Some(PlayerRef::Agent(id)) = player else {
            let all = self.near_of(&[Noun::Agent]);
            self.unknown(Noun::Agent, agent, &all, None);
            return None;
        };
        self.refer(agent, self.players.table.span_of(&agent.text));
        // A player whose name is wrong may be the one that is missing.
        if !players.contains(&PlayerRef::Agent(id)) && !self.unknown_player {
            let message = format!("`{}` does not play in this suite", agent.text);
            self.report(bad_suite(agent.span, message, "add it after `by agents`"));
        }
        let table = &self.agents.beliefs[usize::from(id.0)];
        let Some(belief_id) = table.get(&belief.text).map(crate::BeliefId) else {
            let all: Vec<String> = table.names().filter(|n| !n.starts_with('~')).map(str::to_owned).collect();
            self.unknown(Noun::Belief, belief, &all, None);
            return None;
        };
        let place = table.span(belief_id.0);
        self.refer(belief, place);
        let params = self.s.agents[usize::from(id.0)].beliefs[usize::from(belief_id.0)].params.clone();
        if let Some(param) = params.iter().find(|p| !p.ty.is_finite()) {
            let message =
                format!("`{}` cannot be chosen: `{}` has infinitely many values", belief.text, param.name);
            self.report(bad_suite(
                belief.span,
                message,
                "give the parameter the type `bool`, a range or an enumeration",
            ));
        }
        let how = match per {
            None if any => ChoiceKind::Any,
            None => ChoiceKind::One,
            Some(per) => {
                let all: Vec<String> = params.iter().map(|p| p.name.clone()).collect();
                let Some(at) = all.iter().position(|p| *p == per.text) else {
                    self.unknown(Noun::Parameter, per, &all, Some(Noun::Parameter));
                    return None;
                };
                if let Some(place) = place {
                    self.refer_within(per, place, Noun::Parameter);
                }
                ChoiceKind::OnePer(u16::try_from(at).unwrap_or(u16::MAX))
            }
        };
        Some(TypedChoice { agent: id, belief: belief_id, how, condition: None })
    }

    /// `where F`: a formula over the beliefs of the agent.
    fn choice_condition(
        &mut self,
        agent: &NameSyntax,
        formula: &ast::ExprSyntax,
    ) -> Option<TypedChoiceCondition> {
        let player = self.players.table.get(&agent.text).map(|id| self.players.ids[usize::from(id)]);
        let Some(PlayerRef::Agent(id)) = player else { return None };
        let mut env = ExprEnv { plan: true, noun: Some(Noun::Variable), ..ExprEnv::default() };
        let mut agents = AgentsPhase::over(self.checker, std::mem::take(&mut self.agents));
        let context = agents.context(&AgentScope::of(id), formula, &mut env);
        self.agents = agents.names;
        if env.locals.len() > MAX_NAMES {
            let message = format!("the condition has more than {MAX_NAMES} variables");
            self.report(too_many(message, formula.span));
        }
        let vars = env.locals.iter().map(|l| l.name.clone()).collect();
        Some(TypedChoiceCondition { context, vars, origin: formula.span })
    }

    /// A stimulus that a test can do.
    pub(in crate::check) fn test_stimulus(&mut self, name: &NameSyntax) -> Option<EventId> {
        if let Some(id) = self.events.table.get(&name.text) {
            let event = &self.s.events[usize::from(id)];
            if self.role_of(event.from) == Role::System {
                let actor = self.actor_name(event.from);
                let issue = roles::test_acts_for_system(&name.text, actor, name.span);
                self.report(issue);
                return None;
            }
        }
        self.event(Noun::Stimulus, name, None)
    }

    fn length(&mut self, range: &ast::RangeSyntax) -> Option<(u32, u32)> {
        let lo = self.count(&range.lo, "a length", 0)?;
        let hi = match &range.hi {
            Some(hi) => self.count(hi, "a length", 1)?,
            None => {
                self.report(names::missing(range.span, "a length has an upper end", "write `length 5..20`"));
                return None;
            }
        };
        if lo > hi {
            self.report(types::empty_range(Value::Int(lo), Value::Int(hi), range.span));
        }
        Some((u32::try_from(lo).ok()?, u32::try_from(hi).ok()?))
    }

    fn pause(&mut self, range: &ast::RangeSyntax) -> Option<(f64, f64)> {
        let mut end = |e: &ast::ExprSyntax| {
            self.expr_of(e, InferredType::Float(Dimension::TIME), &mut ExprEnv::constants())
        };
        let lo = end(&range.lo);
        let Some(hi) = range.hi.as_ref().map(end) else {
            self.report(names::missing(range.span, "a pause has an upper end", "write `pause 0 s .. 10 s`"));
            return None;
        };
        self.ordered(&lo, &hi, range.span);
        let (lo, hi) = (lo.constant()?.as_f64()?, hi.constant()?.as_f64()?);
        if lo < 0.0 {
            self.report(types::must_be("a pause", "at least 0 s", range.span));
        }
        Some((lo, hi))
    }
}

fn is_goal(member: &SuiteMember) -> bool {
    matches!(
        member.kind,
        Member::ReachBins(_)
            | Member::ReachLocations
            | Member::ReachEdges
            | Member::ReachEach(_)
            | Member::ReachEachOf { .. }
            | Member::ReachEachBy { .. }
            | Member::ReachOf { .. }
            | Member::ReachQueries(_)
            | Member::Error
    )
}
