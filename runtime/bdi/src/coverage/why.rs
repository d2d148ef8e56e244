//! Why an item was not reached, from the counts of all runs together.

use std::collections::BTreeSet;

use hrdsl_ir::{
    Program,
    bdi::{
        Agent, AgentId, BeliefId, ContentId, GoalId, MessageSubject, Performative, Plan, PlanStepKind,
        TriggerOn,
    },
    cover_item::{AgentCoverItem, ApplicableCount},
};

use super::{
    text::{belief, goal, trigger},
    universe::{is_always_applicable, numbered, sites},
};
use crate::{measure::AgentCounts, show};

/// How many causes of causes are named.
const DEPTH: usize = 3;
/// Plans and steps that are listed, at most.
const LISTED: usize = 4;

/// The agents that were run together, with their counts over all runs.
pub struct AgentTeam<'a> {
    pub program: &'a Program,
    pub measured: &'a [(AgentId, AgentCounts)],
}

/// `once`, `twice`, `12 times`.
#[must_use]
pub fn times(n: u64) -> String {
    match n {
        1 => "once".to_owned(),
        2 => "twice".to_owned(),
        n => format!("{n} times"),
    }
}

impl AgentTeam<'_> {
    /// Why no run reached an item of an agent.
    #[must_use]
    pub fn why(&self, agent: AgentId, item: AgentCoverItem) -> String {
        let member = self.member(agent);
        let Some(member) = member else { return "its agent was not run".to_owned() };
        match item {
            AgentCoverItem::Selected(plan) => member.why_not_selected(plan, DEPTH),
            AgentCoverItem::Completed(plan) => member.why_not_completed(plan),
            AgentCoverItem::Failed(plan) => {
                member.unless_selected(plan, |n| format!("it was selected {n} and never failed"))
            }
            AgentCoverItem::Context { plan, holds: true } => member.why_not_true(plan),
            AgentCoverItem::Context { plan, holds: false } => member.why_not_false(plan),
            AgentCoverItem::Applicable { on, plans } => member.why_not_applicable(on, plans),
            AgentCoverItem::Message { plan, site } => member.unless_selected(plan, |n| {
                format!("its plan was selected {n}, but step {} never sent it", site + 1)
            }),
            AgentCoverItem::Edge { plan, site, by } => member.why_no_edge(plan, site, by),
            AgentCoverItem::Path(plans) => member.why_no_path(plans),
        }
    }

    fn member(&self, id: AgentId) -> Option<TeamMember<'_>> {
        let (_, measured) = self.measured.iter().find(|(a, _)| *a == id)?;
        let agent = self.program.agents.get(usize::from(id.0))?;
        Some(TeamMember { team: self, id, agent, measured })
    }
}

#[derive(Clone, Copy)]
struct TeamMember<'a> {
    team: &'a AgentTeam<'a>,
    id: AgentId,
    agent: &'a Agent,
    measured: &'a AgentCounts,
}

/// A step that could make what a plan waits for.
struct EnablingStep<'a> {
    who: TeamMember<'a>,
    plan: u16,
    site: u16,
}

impl<'a> TeamMember<'a> {
    fn plan(&self, plan: u16) -> Option<&'a Plan> {
        self.agent.plans.get(usize::from(plan))
    }

    fn label(&self, plan: u16) -> &'a str {
        &self.agent.plan(plan).label
    }

    fn selected(&self, plan: u16) -> u64 {
        count(&self.measured.selected, plan)
    }

    /// `text` with how often the plan was selected; if it never was, why not.
    fn unless_selected(&self, plan: u16, text: impl FnOnce(String) -> String) -> String {
        match self.selected(plan) {
            0 => format!("`{}` was never selected: {}", self.label(plan), self.why_not_selected(plan, DEPTH)),
            n => text(times(n)),
        }
    }

    /// How often events came that the trigger is of.
    fn came(&self, on: TriggerOn) -> u64 {
        let counted = self.measured.applicable.get(&on).map_or(0, |n| n.iter().sum());
        // Failure plans are looked for without an event.
        let plans = numbered(self.agent).filter(|(_, p)| p.trigger.on == on);
        plans.map(|(p, _)| self.tried(p)).max().unwrap_or(0).max(counted)
    }

    fn tried(&self, plan: u16) -> u64 {
        let [no, yes] = self.contexts(plan);
        count(&self.measured.unmatched, plan) + no + yes + count(&self.measured.faults, plan)
    }

    fn contexts(&self, plan: u16) -> [u64; 2] {
        self.measured.contexts.get(usize::from(plan)).copied().unwrap_or_default()
    }

    fn why_not_selected(&self, plan: u16, depth: usize) -> String {
        let Some(declared) = self.plan(plan) else { return "there is no such plan".to_owned() };
        let on = declared.trigger.on;
        let name = trigger(self.team.program, self.agent, on);
        let came = self.came(on);
        if came == 0 {
            return format!("`{name}` never came: {}", self.why_never(on, depth));
        }
        let reasons = self.obstacles(plan, declared, came);
        format!("`{name}` came {}: {}", times(came), reasons.join(", "))
    }

    /// What kept the plan from being selected, with how often; the most frequent first.
    fn obstacles(&self, plan: u16, declared: &Plan, came: u64) -> Vec<String> {
        let unmatched = count(&self.measured.unmatched, plan);
        let faults = count(&self.measured.faults, plan);
        let [no, _] = self.contexts(plan);
        let before = came.saturating_sub(unmatched + faults + no);
        let mut reasons = Vec::new();
        if before > 0 {
            let text = match self.selected_before(plan, declared.trigger.on) {
                names if names.is_empty() => format!("{} it was not tried", times(before)),
                names => format!("{} a plan before it was selected ({names})", times(before)),
            };
            reasons.push((before, text));
        }
        if unmatched > 0 {
            reasons.push((unmatched, format!("{} its arguments did not match", times(unmatched))));
        }
        if no > 0 {
            let most = self.blocking(plan, declared).map(|b| format!(" ({b})")).unwrap_or_default();
            reasons.push((no, format!("{} its context was false{most}", times(no))));
        }
        if faults > 0 {
            reasons.push((faults, format!("{} an expression had no value", times(faults))));
        }
        // A stable sort: equal counts stay in the order in which a plan is tried.
        reasons.sort_by_key(|(n, _)| std::cmp::Reverse(*n));
        reasons.into_iter().map(|(_, text)| text).collect()
    }

    /// The plans for the same trigger that are tried before and were selected.
    fn selected_before(&self, plan: u16, on: TriggerOn) -> String {
        let same = numbered(self.agent).filter(|(p, q)| *p < plan && q.trigger.on == on);
        self.tally(same.map(|(p, _)| (p, self.selected(p))))
    }

    /// `leg#1` once, `leg#2` 3 times
    fn tally(&self, plans: impl Iterator<Item = (u16, u64)>) -> String {
        let such = plans.filter(|(_, n)| *n > 0);
        let texts: Vec<String> = such.map(|(p, n)| format!("`{}` {}", self.label(p), times(n))).collect();
        some_of(&texts, ", ")
    }

    /// The part of the context that most often had no answer.
    fn blocking(&self, plan: u16, declared: &Plan) -> Option<String> {
        let blocked = self.measured.blocked.get(usize::from(plan))?;
        let most = blocked.iter().copied().max().filter(|n| *n > 0)?;
        let at = blocked.iter().position(|n| *n == most)?;
        let part = declared.context.conjuncts().get(at)?;
        let text = show::context(self.team.program, self.agent, &declared.vars, part);
        Some(match blocked.len() {
            1 => format!("`{text}`"),
            _ => format!("mostly for want of `{text}`: {}", times(most)),
        })
    }

    fn why_not_true(&self, plan: u16) -> String {
        match self.contexts(plan) {
            [0, _] => format!("it was never tried: {}", self.why_not_selected(plan, DEPTH)),
            [..] => self.why_not_selected(plan, DEPTH),
        }
    }

    fn why_not_false(&self, plan: u16) -> String {
        match self.contexts(plan) {
            [_, 0] => format!("it was never tried: {}", self.why_not_selected(plan, DEPTH)),
            [_, n] => format!("it was true each time that it was tried: {}", times(n)),
        }
    }

    fn why_not_completed(&self, plan: u16) -> String {
        self.unless_selected(plan, |n| match count(&self.measured.failed, plan) {
            0 => format!("it was selected {n} and still pursued, or dropped, when the runs ended"),
            failed => format!("it was selected {n} and failed {}", times(failed)),
        })
    }

    fn why_not_applicable(&self, on: TriggerOn, plans: ApplicableCount) -> String {
        let name = trigger(self.team.program, self.agent, on);
        let Some([none, one, many]) = self.measured.applicable.get(&on).copied().filter(|n| *n != [0; 3])
        else {
            return format!("`{name}` never came: {}", self.why_never(on, DEPTH));
        };
        let found = [(none, "no plan was"), (one, "just one plan was"), (many, "several plans were")];
        let found = found.into_iter().filter(|(n, _)| *n > 0);
        let found: Vec<String> = found.map(|(n, what)| format!("{} {what} applicable", times(n))).collect();
        let always = match plans {
            ApplicableCount::One => numbered(self.agent)
                .find(|(_, p)| p.trigger.on == on && is_always_applicable(p))
                .filter(|_| one == 0),
            ApplicableCount::None | ApplicableCount::Many => None,
        };
        let always = always.map(|(p, _)| format!("; `{}` always is", self.label(p))).unwrap_or_default();
        format!("`{name}` came {}: {}{always}", times(none + one + many), found.join(", "))
    }

    fn why_no_edge(&self, plan: u16, site: u16, by: u16) -> String {
        self.unless_selected(plan, |n| {
            let step = site + 1;
            let taken = self.measured.edges.range((plan, site, 0)..=(plan, site, u16::MAX));
            let taken: Vec<(u16, u64)> = taken.map(|((_, _, by), n)| (*by, *n)).collect();
            if taken.iter().all(|(_, n)| *n == 0) {
                return format!(
                    "`{}` was selected {n}, but no plan was ever selected for its step {step}",
                    self.label(plan)
                );
            }
            let others = self.tally(taken.into_iter());
            let why = match self.selected(by) {
                0 => {
                    format!("; `{}` was never selected: {}", self.label(by), self.why_not_selected(by, DEPTH))
                }
                n => format!("; `{}` was selected {} for other goals", self.label(by), times(n)),
            };
            format!("for this step others were selected ({others}){why}")
        })
    }

    fn why_no_path(&self, [a, b, c]: [u16; 3]) -> String {
        for (plan, by) in [(a, b), (b, c)] {
            let taken = |(at, n): (&(u16, u16, u16), &u64)| at.0 == plan && at.2 == by && *n > 0;
            if self.measured.edges.iter().any(taken) {
                continue;
            }
            return match self.call(plan, by) {
                Some(site) => format!(
                    "`{}` never led to `{}`: {}",
                    self.label(plan),
                    self.label(by),
                    self.why_no_edge(plan, site, by)
                ),
                None => format!("`{}` does not call `{}`", self.label(plan), self.label(by)),
            };
        }
        format!(
            "`{}` led to `{}`, and that to `{}`, but never one on the other",
            self.label(a),
            self.label(b),
            self.label(c)
        )
    }

    /// The first step of a plan that calls for the goal of another.
    fn call(&self, plan: u16, by: u16) -> Option<u16> {
        let TriggerOn::GoalAdded(wanted) = self.plan(by)?.trigger.on else { return None };
        let is_call =
            |kind: &PlanStepKind| matches!(kind, PlanStepKind::Achieve { goal, .. } if *goal == wanted);
        let steps = (0u16..).zip(sites(self.plan(plan)?));
        steps.filter(|(_, s)| is_call(&s.kind)).map(|(site, _)| site).next()
    }

    /// Why nothing of a trigger came.
    fn why_never(&self, on: TriggerOn, depth: usize) -> String {
        let program = self.team.program;
        match on {
            TriggerOn::GoalAdded(wanted) => {
                let own = |k: &PlanStepKind| matches!(k, PlanStepKind::Achieve { goal, .. } | PlanStepKind::Spawn { goal, .. } if *goal == wanted);
                let told = self.messages(MessageSubject::Goal(wanted), &[Performative::Achieve]);
                self.because(self.own_steps(own).chain(told).collect(), on, "adopts it", depth)
            }
            TriggerOn::GoalFailed(wanted) => self.why_never_failed(wanted, depth),
            TriggerOn::BeliefAdded(wanted) => {
                if let Some(event) = self.agent.belief(wanted).percept {
                    return format!("`{}` was never perceived", program.event(event).name);
                }
                let is_it =
                    |content: &ContentId| self.subject(*content) == Some(MessageSubject::Belief(wanted));
                let own = |k: &PlanStepKind| {
                    matches!(k, PlanStepKind::Add(a) | PlanStepKind::Replace(a) if a.belief == wanted)
                        || matches!(k, PlanStepKind::Send { performative, content, .. }
                            if is_question(*performative) && is_it(content))
                };
                let told = self.messages(MessageSubject::Belief(wanted), &[Performative::Tell]);
                self.because(self.own_steps(own).chain(told).collect(), on, "adds it", depth)
            }
            TriggerOn::BeliefRemoved(wanted) => {
                let own = |k: &PlanStepKind| {
                    matches!(k, PlanStepKind::Remove(l) | PlanStepKind::Abolish(l) if l.belief == wanted)
                        || matches!(k, PlanStepKind::Replace(a) if a.belief == wanted)
                };
                let told = self.messages(MessageSubject::Belief(wanted), &[Performative::Untell]);
                self.because(self.own_steps(own).chain(told).collect(), on, "removes it", depth)
            }
            TriggerOn::TestAdded(wanted) => self.why_never_asked(wanted, depth),
            TriggerOn::TestFailed(wanted) => {
                format!("no plan for `+?{}` failed", belief(self.agent, wanted))
            }
            TriggerOn::Perceived(event) => {
                let event = program.event(event);
                let maker = &program.actor(event.from).name;
                format!("`{maker}` never made `{}` when the agent could perceive it", event.name)
            }
        }
    }

    fn why_never_failed(&self, wanted: GoalId, depth: usize) -> String {
        let added = TriggerOn::GoalAdded(wanted);
        match self.came(added) {
            0 if depth > 0 => {
                format!(
                    "`!{}` was never adopted: {}",
                    goal(self.agent, wanted),
                    self.why_never(added, depth - 1)
                )
            }
            0 => format!("`!{}` was never adopted", goal(self.agent, wanted)),
            n => format!("`!{}` was adopted {} and never failed", goal(self.agent, wanted), times(n)),
        }
    }

    fn why_never_asked(&self, wanted: BeliefId, depth: usize) -> String {
        let own = |k: &PlanStepKind| matches!(k, PlanStepKind::Query(l) if l.belief == wanted);
        let asked = self.messages(MessageSubject::Belief(wanted), &[Performative::AskOne]);
        let makers: Vec<EnablingStep<'_>> = self.own_steps(own).chain(asked).collect();
        let is_run = |m: &EnablingStep<'_>| m.who.selected(m.plan) > 0;
        if makers.iter().any(is_run) {
            return format!("each `?{}` found an answer among the beliefs", belief(self.agent, wanted));
        }
        self.because(makers, TriggerOn::TestAdded(wanted), "asks for it", depth)
    }

    /// The steps of the agent's plans that are so.
    fn own_steps<F: Fn(&PlanStepKind) -> bool>(self, is_so: F) -> impl Iterator<Item = EnablingStep<'a>> {
        let mut found = Vec::new();
        for (plan, declared) in numbered(self.agent) {
            for (site, step) in (0u16..).zip(sites(declared)) {
                if is_so(&step.kind) {
                    found.push(EnablingStep { who: self, plan, site });
                }
            }
        }
        found.into_iter()
    }

    /// The steps of other agents that send such a message about this.
    fn messages(&self, about: MessageSubject, performatives: &[Performative]) -> Vec<EnablingStep<'a>> {
        let team = self.team;
        let others = team.measured.iter().filter(|(a, _)| *a != self.id).filter_map(|(a, _)| team.member(*a));
        let is_it = |content: &ContentId| self.subject(*content) == Some(about);
        let asks = performatives.contains(&Performative::AskOne);
        let is_so = |k: &PlanStepKind| {
            matches!(k, PlanStepKind::Send { performative, content, .. } if performatives.contains(performative) && is_it(content))
                || matches!(k, PlanStepKind::Ask { content, .. } if asks && is_it(content))
        };
        others.flat_map(|other| other.own_steps(is_so).collect::<Vec<_>>()).collect()
    }

    /// What a message's content is to this agent.
    fn subject(&self, content: ContentId) -> Option<MessageSubject> {
        let content = self.team.program.contents.get(usize::from(content.0))?;
        content.of.get(usize::from(self.id.0)).copied().flatten()
    }

    /// Why none of the steps that could have made something did.
    fn because(&self, mut makers: Vec<EnablingStep<'_>>, on: TriggerOn, verb: &str, depth: usize) -> String {
        let is_any = !makers.is_empty();
        // What needs the trigger itself is no beginning.
        makers.retain(|m| m.who.id != self.id || self.plan(m.plan).is_none_or(|p| p.trigger.on != on));
        let Some(first) = makers.first() else {
            let but = if is_any { " but its own plans" } else { "" };
            return format!("nothing{but} {verb}");
        };
        let place = |m: &EnablingStep<'_>| {
            let owner = if m.who.id == self.id { String::new() } else { format!("{}.", m.who.agent.name) };
            format!("`{owner}{}` (step {})", m.who.label(m.plan), m.site + 1)
        };
        let run: Vec<&EnablingStep<'_>> = makers.iter().filter(|m| m.who.selected(m.plan) > 0).collect();
        if run.is_empty() {
            let places: Vec<String> = makers.iter().map(place).collect();
            let plans: BTreeSet<(AgentId, u16)> = makers.iter().map(|m| (m.who.id, m.plan)).collect();
            let text = format!("only {} {verb}, never selected", some_of(&places, " or "));
            // With one plan the question goes on there.
            return match plans.len() {
                1 if depth > 0 => format!("{text}: {}", first.who.why_not_selected(first.plan, depth - 1)),
                _ => text,
            };
        }
        let places: Vec<String> =
            run.iter().map(|m| format!("{}, selected {}", place(m), times(m.who.selected(m.plan)))).collect();
        format!("what {verb} was never executed: {}", some_of(&places, "; "))
    }
}

/// Whether the answer to it is told.
fn is_question(performative: Performative) -> bool {
    match performative {
        Performative::AskOne | Performative::AskAll => true,
        Performative::Tell | Performative::Untell | Performative::Achieve | Performative::Unachieve => false,
    }
}

fn count(counts: &[u64], plan: u16) -> u64 {
    counts.get(usize::from(plan)).copied().unwrap_or(0)
}

/// The first few, and how many more there are.
fn some_of(texts: &[String], between: &str) -> String {
    let shown = texts[..texts.len().min(LISTED)].join(between);
    match texts.len().saturating_sub(LISTED) {
        0 => shown,
        more => format!("{shown} and {more} more"),
    }
}

#[cfg(test)]
mod tests {
    use super::{super::fixture, *};

    struct TeamFixture {
        program: Program,
        measured: Vec<(AgentId, AgentCounts)>,
    }

    fn setting() -> TeamFixture {
        let program = fixture::program();
        let measured =
            (0u16..).map(AgentId).zip(&program.agents).map(|(id, a)| (id, AgentCounts::new(a))).collect();
        TeamFixture { program, measured }
    }

    impl TeamFixture {
        fn human(&mut self) -> &mut AgentCounts {
            &mut self.measured[0].1
        }

        fn why(&self, agent: u16, item: AgentCoverItem) -> String {
            AgentTeam { program: &self.program, measured: &self.measured }.why(AgentId(agent), item)
        }
    }

    const TABLE: TriggerOn = TriggerOn::GoalAdded(GoalId(0));
    const LEG: TriggerOn = TriggerOn::GoalAdded(GoalId(1));

    #[test]
    fn a_trigger_that_never_came_is_followed_to_its_cause() {
        let mut s = setting();
        assert_eq!(
            s.why(0, AgentCoverItem::Selected(5)),
            "`on discarded` never came: `robot` never made `discarded` when the agent could perceive it"
        );
        assert_eq!(
            s.why(1, AgentCoverItem::Selected(0)),
            "`+seen` never came: only `Human.table#1` (step 2) adds it, never selected: `+!table` never came: nothing \
             but its own plans adopts it"
        );
        assert_eq!(
            s.why(0, AgentCoverItem::Selected(2)),
            "`+!leg` never came: only `table#1` (step 1) or `sit#1` (step 2) adopts it, never selected"
        );
        s.human().selected[0] = 3;
        assert_eq!(
            s.why(1, AgentCoverItem::Selected(0)),
            "`+seen` never came: what adds it was never executed: `Human.table#1` (step 2), selected 3 times"
        );
    }

    #[test]
    fn what_kept_a_plan_back_is_counted() {
        let mut s = setting();
        let m = s.human();
        m.applicable.insert(TABLE, [0, 9, 3]);
        m.selected[1] = 9;
        m.contexts[0] = [9, 3];
        m.blocked[0] = vec![1, 6, 2];
        m.selected[0] = 3;
        m.contexts[1] = [0, 9];
        m.applicable.insert(LEG, [0, 10, 2]);
        m.selected[2] = 5;
        m.selected[4] = 7;
        m.contexts[3] = [3, 0];
        m.blocked[3] = vec![3];
        m.unmatched[3] = 3;
        m.faults[3] = 1;
        assert_eq!(
            s.why(0, AgentCoverItem::Selected(3)),
            "`+!leg` came 12 times: 5 times a plan before it was selected (`leg#1` 5 times), 3 times its arguments did \
             not match, 3 times its context was false (`near(_) || tired`), once an expression had no value"
        );
        s.human().selected[0] = 0;
        assert_eq!(
            s.why(0, AgentCoverItem::Selected(0)),
            "`+!table` came 12 times: 9 times its context was false (mostly for want of `N > 0`: 6 times), 3 times it \
             was not tried"
        );
    }

    #[test]
    fn other_items_are_led_back_to_plans() {
        let mut s = setting();
        let m = s.human();
        m.selected[0] = 4;
        m.contexts[0] = [0, 4];
        m.failed[0] = 1;
        m.selected[4] = 3;
        m.edges.insert((0, 0, 4), 3);
        m.applicable.insert(TABLE, [0, 0, 4]);
        m.applicable.insert(LEG, [0, 3, 0]);
        m.contexts[2] = [3, 0];
        m.blocked[2] = vec![3];
        assert_eq!(s.why(0, AgentCoverItem::Completed(0)), "it was selected 4 times and failed once");
        assert_eq!(s.why(0, AgentCoverItem::Failed(4)), "it was selected 3 times and never failed");
        assert_eq!(
            s.why(0, AgentCoverItem::Context { plan: 0, holds: false }),
            "it was true each time that it was tried: 4 times"
        );
        assert_eq!(
            s.why(0, AgentCoverItem::Context { plan: 2, holds: true }),
            "`+!leg` came 3 times: 3 times its context was false (`near(_)`)"
        );
        assert_eq!(
            s.why(0, AgentCoverItem::Edge { plan: 0, site: 0, by: 2 }),
            "for this step others were selected (`leg#3` 3 times); `leg#1` was never selected: `+!leg` came 3 times: 3 \
             times its context was false (`near(_)`)"
        );
        assert_eq!(
            s.why(0, AgentCoverItem::Path([0, 0, 4])),
            "`table#1` never led to `table#1`: `table#1` was selected 4 times, but no plan was ever selected for its \
             step 3"
        );
        s.human().edges.insert((0, 2, 0), 1);
        assert_eq!(
            s.why(0, AgentCoverItem::Path([0, 0, 4])),
            "`table#1` led to `table#1`, and that to `leg#3`, but never one on the other"
        );
        assert_eq!(
            s.why(0, AgentCoverItem::Message { plan: 0, site: 1 }),
            "its plan was selected 4 times, but step 2 never sent it"
        );
        assert_eq!(
            s.why(0, AgentCoverItem::Applicable { on: TABLE, plans: ApplicableCount::One }),
            "`+!table` came 4 times: 4 times several plans were applicable; `table#2` always is"
        );
    }

    #[test]
    fn an_agent_that_was_not_run_is_said_so() {
        let mut s = setting();
        s.measured.truncate(1);
        assert_eq!(s.why(1, AgentCoverItem::Selected(0)), "its agent was not run");
        assert_eq!(s.why(0, AgentCoverItem::Selected(99)), "there is no such plan");
    }
}
