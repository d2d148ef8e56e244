//! HR0107: declarations that nothing uses. What suites use is told only if there are suites or tests.

use std::collections::BTreeSet;

use hrdsl_source::{Diagnostic, DiagnosticCode, FileId, Span};

use super::{
    agent_facts::{all_steps, change},
    events::own_events,
    facts::ScenarioFacts,
    query_reads::QueryReads,
};
use crate::{
    ActorId, AutomatonId, AutomatonVar, FunctionEffects, MessageSubject, NameDefinition, NetworkId,
    Performative, PlayerRef, Role, Scenario, TypedAgent, TypedAutomaton, TypedContext, TypedExpr,
    TypedMethod, TypedStepKind, TypedSync, TypedTime, TypedUpdate, VariableRef, leaves, noun::Noun,
};

pub(crate) fn check<'a>(scenario: &'a Scenario, facts: &'a ScenarioFacts<'a>, issues: &mut Vec<Diagnostic>) {
    let mut found = Vec::new();
    mentioned(scenario, &mut found);
    vocabulary(scenario, facts, &mut found);
    let queries = QueryReads::of(scenario);
    if facts.has_tests {
        players(scenario, &queries, &mut found);
    }
    scenario.agents.iter().enumerate().for_each(|(i, a)| beliefs(scenario, i, a, &mut found));
    variables(scenario, &queries, &mut found);
    signals(scenario, &mut found);
    issues.extend(found.into_iter().filter(|u| u.at.file == FileId(0)).map(UnusedName::said));
}

/// A declaration that nothing uses.
struct UnusedName<'a> {
    noun: Noun,
    name: &'a str,
    at: Span,
    /// What is not done with it.
    lacks: &'static str,
    /// The whole declaration, if nothing speaks of it; and whether nobody can miss it.
    whole: Option<(Span, bool)>,
}

impl UnusedName<'_> {
    fn said(self) -> Diagnostic {
        let Self { noun, name, at, lacks, whole } = self;
        let message = format!("the {noun} `{name}` is never {lacks}");
        let issue = Diagnostic::warning(DiagnosticCode::UNUSED, at, message);
        match whole {
            // One of several that are declared together cannot simply go.
            Some((span, _)) if span == at => issue.help("use it, or delete it"),
            Some((span, certain)) => {
                issue.help("use it, or delete it").fix(format!("delete `{name}`"), span, "", certain)
            }
            None => issue.help("use it, or delete it and what sets it"),
        }
    }
}

/// Declarations of which nothing is left where they are used: they are, if their names are mentioned.
fn mentioned<'a>(scenario: &'a Scenario, found: &mut Vec<UnusedName<'a>>) {
    let names = &scenario.names;
    let mut add = |noun: Noun, declared: &'a NameDefinition| {
        if !names.is_used(declared.place) {
            let (name, at, whole) = (declared.name.as_str(), declared.place, Some((declared.whole, true)));
            found.push(UnusedName { noun, name, at, lacks: "used", whole });
        }
    };
    for noun in [Noun::Constant, Noun::Enum, Noun::Record, Noun::Part, Noun::Template] {
        names.all_of(noun).for_each(|declared| add(noun, declared));
    }
    // Those of automata are visible there only.
    let functions = names.definitions().filter(|declared| declared.noun == Noun::Function.word());
    functions.for_each(|declared| add(Noun::Function, declared));
}

fn vocabulary<'a>(scenario: &'a Scenario, facts: &ScenarioFacts, found: &mut Vec<UnusedName<'a>>) {
    for (id, event, at) in own_events(scenario) {
        if facts.made(id) || facts.read(id) {
            continue;
        }
        let name = event.name.as_str();
        found.push(if event.stimulus.is_some() {
            UnusedName { noun: Noun::Stimulus, name, at, lacks: "done", whole: Some((event.origin, false)) }
        } else {
            UnusedName {
                noun: Noun::Event,
                name,
                at,
                lacks: "made nor taken",
                whole: Some((event.origin, true)),
            }
        });
    }
}

/// Agents and automata that play in no suite, networks that neither a suite nor a query searches.
fn players<'a>(scenario: &'a Scenario, queries: &QueryReads, found: &mut Vec<UnusedName<'a>>) {
    let mut agents = vec![false; scenario.agents.len()];
    let mut automata = vec![false; scenario.automata.len()];
    let mut networks = queries.networks.clone();
    let set =
        |used: &mut [bool], i: u16| used.iter_mut().skip(usize::from(i)).take(1).for_each(|u| *u = true);
    for suite in &scenario.suites {
        match &suite.method {
            TypedMethod::Agents { players, .. } => players.iter().for_each(|p| match p {
                PlayerRef::Agent(a) => set(&mut agents, a.0),
                PlayerRef::Automaton(a) => set(&mut automata, a.0),
            }),
            TypedMethod::Search { network: NetworkId(n), .. } => set(&mut networks, *n),
            TypedMethod::Random { .. } => {}
        }
    }
    for AutomatonId(a) in scenario.networks.iter().flat_map(|n| &n.automata) {
        set(&mut automata, *a);
    }
    let places = &scenario.places;
    for (i, agent) in scenario.agents.iter().enumerate().filter(|(i, _)| !agents[*i]) {
        let at = places.agents.get(i).map_or(agent.origin, |p| p.name);
        let whole = Some((agent.origin, false));
        found.push(UnusedName {
            noun: Noun::Agent,
            name: &agent.name,
            at,
            lacks: "played in a suite",
            whole,
        });
    }
    for (i, automaton) in scenario.automata.iter().enumerate().filter(|(i, _)| !automata[*i]) {
        let at = places.automata.get(i).map_or(automaton.origin, |p| p.name);
        let (name, whole) = (automaton.name.as_str(), Some((automaton.origin, false)));
        found.push(UnusedName {
            noun: Noun::Automaton,
            name,
            at,
            lacks: "played in a suite or network",
            whole,
        });
    }
    for (i, network) in scenario.networks.iter().enumerate().filter(|(i, _)| !networks[*i]) {
        let at = places.networks.get(i).copied().unwrap_or(network.origin);
        let whole = Some((network.origin, false));
        found.push(UnusedName {
            noun: Noun::Network,
            name: &network.name,
            at,
            lacks: "searched by a suite",
            whole,
        });
    }
}

fn beliefs<'a>(scenario: &'a Scenario, index: usize, agent: &'a TypedAgent, found: &mut Vec<UnusedName<'a>>) {
    let mut read = vec![false; agent.beliefs.len()];
    let mut named = vec![false; agent.beliefs.len()];
    for plan in &agent.plans {
        plan.trigger.on.belief().iter().for_each(|b| read[usize::from(b.0)] = true);
        reads_beliefs(&plan.context, &mut read);
        for step in all_steps(&plan.body) {
            step.condition().iter().for_each(|c| reads_beliefs(c, &mut read));
            if let TypedStepKind::Query(literal) = &step.kind {
                read[usize::from(literal.belief.0)] = true;
            }
            change(step).iter().for_each(|c| named[usize::from(c.belief().0)] = true);
        }
    }
    for rule in &agent.rules {
        reads_beliefs(&rule.body, &mut read);
        named[usize::from(rule.belief.0)] = true;
    }
    of_messages(scenario, index, &mut read, &mut named);
    for (i, belief) in agent.beliefs.iter().enumerate() {
        if let Some(plain) = belief.negates {
            // The declaration is of both.
            read[usize::from(plain.0)] |= read[i];
            named[usize::from(plain.0)] = true;
        }
    }
    for suite in &scenario.suites {
        let TypedMethod::Agents { choose, .. } = &suite.method else { continue };
        for choice in choose.iter().filter(|c| usize::from(c.agent.0) == index) {
            named[usize::from(choice.belief.0)] = true;
            choice.condition.iter().for_each(|c| reads_beliefs(&c.context, &mut read));
        }
    }
    let places = scenario.places.agents.get(index);
    let unread = |(i, b): &(usize, &crate::BeliefDecl)| !read[*i] && b.negates.is_none();
    for (i, belief) in agent.beliefs.iter().enumerate().filter(unread) {
        let at = places.and_then(|p| p.beliefs.get(i)).copied().unwrap_or(belief.origin);
        let whole = (!named[i]).then_some((belief.origin, true));
        found.push(UnusedName { noun: Noun::Belief, name: &belief.name, at, lacks: "read", whole });
    }
}

fn reads_beliefs(context: &TypedContext, read: &mut [bool]) {
    context.each(&mut |part| {
        if let TypedContext::Belief(literal) = part {
            read[usize::from(literal.belief.0)] = true;
        }
    });
}

/// What agents tell this one is named, and what they ask it is read.
fn of_messages(scenario: &Scenario, index: usize, read: &mut [bool], named: &mut [bool]) {
    let asks =
        |how: Option<Performative>| matches!(how, None | Some(Performative::AskOne | Performative::AskAll));
    for (content, speech) in scenario.contents.iter().zip(&scenario.speech) {
        if let Some(Some(MessageSubject::Belief(belief))) = content.of.get(index) {
            read[usize::from(belief.0)] |= speech.uses.iter().any(|(how, _)| asks(*how));
            named[usize::from(belief.0)] = true;
        }
    }
}

/// What is read and what is set of some variables.
struct NameUses {
    read: Vec<bool>,
    set: Vec<bool>,
}

impl NameUses {
    fn new(count: usize) -> Self {
        Self { read: vec![false; count], set: vec![false; count] }
    }

    fn read_by(read: &[bool]) -> Self {
        Self { read: read.to_vec(), ..Self::new(read.len()) }
    }
}

fn or(read: &mut [bool], more: &[bool]) {
    read.iter_mut().zip(more).for_each(|(read, more)| *read |= *more);
}

/// Marks the variables that an expression reads; `but` is the one it is for.
fn reads(e: &TypedExpr, own: &mut NameUses, shared: &mut NameUses, but: Option<VariableRef>) {
    e.each_leaf(&mut |leaf| {
        if Some(leaf) == but {
            return;
        }
        match leaf {
            VariableRef::Own(i) => own.read[usize::from(i)] = true,
            VariableRef::Shared(i) => shared.read[usize::from(i)] = true,
            VariableRef::Local(_) | VariableRef::Signal(_) => {}
        }
    });
}

fn variables<'a>(scenario: &'a Scenario, queries: &QueryReads, found: &mut Vec<UnusedName<'a>>) {
    let mut shared = NameUses::read_by(&queries.shared.vars);
    let owned = |owner: Option<AutomatonId>| -> Vec<&FunctionEffects> {
        let all = scenario.functions.iter().zip(&scenario.effects);
        all.filter(|(f, _)| f.owner == owner).map(|(_, effects)| effects).collect()
    };
    in_functions(&owned(None), &mut NameUses::new(0), &mut shared);
    let first = scenario.clocks.len();
    let mut shared_clocks = NameUses::read_by(&queries.shared.clocks);
    for (index, automaton) in scenario.automata.iter().enumerate() {
        let (mut own, mut clocks) = uses_of(automaton, first, &mut shared);
        or(&mut own.read, &queries.automata[index].vars);
        or(&mut clocks.read[first..], &queries.automata[index].clocks);
        let id = u16::try_from(index).ok().map(AutomatonId);
        in_functions(&owned(id), &mut own, &mut shared);
        for (i, (read, set)) in clocks.read.iter().zip(&clocks.set).take(first).enumerate() {
            shared_clocks.read[i] |= *read;
            shared_clocks.set[i] |= *set;
        }
        let places = scenario.places.automata.get(index);
        for (i, clock) in automaton.clocks.iter().enumerate().filter(|(i, _)| !clocks.read[first + *i]) {
            let at = places.and_then(|p| p.clocks.get(i)).copied().unwrap_or(automaton.origin);
            // Several clocks may share a declaration: there is no text that can simply go.
            found.push(UnusedName { noun: Noun::Clock, name: clock, at, lacks: "read", whole: None });
        }
        for i in unread(&automaton.vars, &mut own) {
            let var = &automaton.vars[i];
            let place = places.and_then(|p| p.vars.get(i));
            let at = place.map_or(automaton.origin, |p| p.name);
            let whole = place.filter(|_| !own.set[i]).map(|p| (p.whole, true));
            found.push(UnusedName {
                noun: Noun::Variable,
                name: whole_name(&var.name),
                at,
                lacks: "read",
                whole,
            });
        }
    }
    unread_clocks(scenario, &shared_clocks, found);
    for i in unread(&scenario.shared, &mut shared) {
        let var = &scenario.shared[i];
        let Some(place) = scenario.places.shared.get(i) else { continue };
        let whole = (!shared.set[i]).then_some((place.whole, true));
        let (name, at) = (whole_name(&var.name), place.name);
        found.push(UnusedName { noun: Noun::Variable, name, at, lacks: "read", whole });
    }
}

/// Shared clocks; an array of which one is read is read.
fn unread_clocks<'a>(scenario: &'a Scenario, uses: &NameUses, found: &mut Vec<UnusedName<'a>>) {
    let mut at = 0;
    for places in scenario.places.clocks.chunk_by(|a, b| a == b) {
        let part = at..at + places.len();
        let first = &scenario.clocks[at];
        at = part.end;
        if uses.read[part.clone()].contains(&true) {
            continue;
        }
        let place = places[0];
        let whole = (!uses.set[part].contains(&true)).then_some((place.whole, true));
        let name = whole_name(first);
        found.push(UnusedName { noun: Noun::Clock, name, at: place.name, lacks: "read", whole });
    }
}

/// The name of the variable that this is a part of.
fn whole_name(part: &str) -> &str {
    part.split(['.', '[']).next().unwrap_or(part)
}

/// The first parts of the variables of which no part is read; a part that is set stands for them all.
fn unread(vars: &[AutomatonVar], uses: &mut NameUses) -> Vec<usize> {
    let mut first = Vec::new();
    let mut at = 0;
    while at < vars.len() {
        let name = whole_name(&vars[at].name);
        let parts = vars[at..].iter().take_while(|v| whole_name(&v.name) == name);
        let end = at + parts.count().max(1);
        if !uses.read[at..end].contains(&true) {
            uses.set[at] |= uses.set[at..end].contains(&true);
            first.push(at);
        }
        at = end;
    }
    first
}

fn sets(leaf: VariableRef, own: &mut NameUses, shared: &mut NameUses) {
    match leaf {
        VariableRef::Own(i) => own.set[usize::from(i)] = true,
        VariableRef::Shared(i) => shared.set[usize::from(i)] = true,
        VariableRef::Local(_) | VariableRef::Signal(_) => {}
    }
}

/// What functions read and assign, whether they are called or not.
fn in_functions(functions: &[&FunctionEffects], own: &mut NameUses, shared: &mut NameUses) {
    for effects in functions {
        for leaf in &effects.reads {
            match leaf {
                VariableRef::Own(i) => own.read[usize::from(*i)] = true,
                VariableRef::Shared(i) => shared.read[usize::from(*i)] = true,
                VariableRef::Local(_) | VariableRef::Signal(_) => {}
            }
        }
        effects.assigns.iter().for_each(|l| sets(*l, own, shared));
    }
}

/// The uses of an automaton's own variables, and of all clocks that it sees, the shared ones first.
fn uses_of(automaton: &TypedAutomaton, shared_clocks: usize, shared: &mut NameUses) -> (NameUses, NameUses) {
    let mut own = NameUses::new(automaton.vars.len());
    let mut clocks = NameUses::new(shared_clocks + automaton.clocks.len());
    let bounds = automaton.locations.iter().flat_map(|l| &l.invariant);
    for bound in bounds.chain(automaton.edges.iter().flat_map(|e| &e.clock_guard)) {
        bound.clocks().for_each(|c| clocks.read[usize::from(c.0)] = true);
        reads_time(&bound.bound, &mut own, shared);
    }
    for holds in automaton.locations.iter().filter_map(|l| l.holds.as_ref()) {
        reads(holds, &mut own, shared, None);
    }
    for edge in &automaton.edges {
        if let Some(guard) = &edge.guard {
            reads(guard, &mut own, shared, None);
        }
        match &edge.sync {
            TypedSync::Send { args, .. } | TypedSync::Offer { args, .. } => {
                args.iter().for_each(|e| reads(e, &mut own, shared, None));
            }
            TypedSync::Internal
            | TypedSync::Receive { .. }
            | TypedSync::Accept { .. }
            | TypedSync::Join { .. } => {}
        }
        for update in &edge.updates {
            match update {
                TypedUpdate::Assign { place, value } => {
                    // What only its own next value is made of is not read.
                    let itself = place.indices.is_empty().then_some(place.slot);
                    reads(value, &mut own, shared, itself);
                    place.indices.iter().for_each(|i| reads(&i.at, &mut own, shared, None));
                    leaves(place).into_iter().for_each(|l| sets(l, &mut own, shared));
                }
                TypedUpdate::Call { args, .. } => args.iter().for_each(|e| reads(e, &mut own, shared, None)),
                TypedUpdate::Reset { clock, from, to } => {
                    clocks.set[usize::from(clock.0)] = true;
                    let other = from.filter(|f| f != clock);
                    other.iter().for_each(|c| clocks.read[usize::from(c.0)] = true);
                    reads_time(to, &mut own, shared);
                }
            }
        }
    }
    (own, clocks)
}

fn reads_time(time: &TypedTime, own: &mut NameUses, shared: &mut NameUses) {
    time.terms.iter().for_each(|t| reads(&t.value, own, shared, None));
}

/// Signals that are neither sent to code nor mentioned: nothing sets a signal, so that whoever names it reads it.
fn signals<'a>(scenario: &'a Scenario, found: &mut Vec<UnusedName<'a>>) {
    let Some(world) = &scenario.world else { return };
    // Only the code of a system actor reads signals by itself.
    let is_code = |a: &ActorId| scenario.actors.get(usize::from(a.0)).is_some_and(|a| a.role == Role::System);
    // Each instance of a part has the part's signals, which are declared once.
    let mut seen = BTreeSet::new();
    for (signal, at) in world.signals.iter().zip(&scenario.places.signals) {
        if scenario.names.is_used(*at) || signal.to.iter().any(is_code) || !seen.insert(*at) {
            continue;
        }
        let name = scenario.names.defined_at(*at).map_or(&signal.name, |declared| &declared.name);
        let whole = Some((signal.span, true));
        found.push(UnusedName { noun: Noun::Signal, name, at: *at, lacks: "read", whole });
    }
}
