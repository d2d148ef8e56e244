//! Checks that an automaton is well formed, so that engines can index without looking.

use hrdsl_ir::{
    Expr, Program,
    expr::Lvalue,
    ta::{
        Automaton, AutomatonFunction, AutomatonId, AutomatonVar, ChannelId, ChannelKind, ClockConstraint,
        ClockId, EdgeAssignment, FunctionStatement, LocationId, SyncLabel, TimeSum,
    },
};

use crate::network::error::ModelError;

/// The automaton of this id, if all its indices are within bounds.
///
/// # Errors
/// `Malformed` says what is not.
pub(crate) fn automaton(program: &Program, id: AutomatonId) -> Result<&Automaton, ModelError> {
    let Some(automaton) = program.automata.get(usize::from(id.0)) else {
        return Err(ModelError::Malformed { automaton: format!("#{}", id.0), what: "does not exist".into() });
    };
    let sizes = [program.shared.len() + automaton.vars.len(), program.clocks.len() + automaton.clocks.len()];
    let what = if sizes.iter().any(|n| *n >= usize::from(u16::MAX)) {
        Some("has too many variables or clocks".to_owned())
    } else {
        fault(program, id, automaton)
    };
    match what {
        None => Ok(automaton),
        Some(what) => Err(ModelError::Malformed { automaton: automaton.name.clone(), what }),
    }
}

fn fault(program: &Program, id: AutomatonId, a: &Automaton) -> Option<String> {
    let locations = a.locations.len();
    let known = |l: LocationId| usize::from(l.0) < locations;
    if !known(a.initial) {
        return Some("no initial location".into());
    }
    if let Some(v) = program.shared.iter().chain(&a.vars).find(|v| !range_is_sound(v)) {
        return Some(format!("the range of `{}` does not hold its initial value", v.name));
    }
    let selects = a.edges.iter().flat_map(|e| &e.selects);
    if let Some(v) = program.shared.iter().chain(&a.vars).chain(selects).find(|v| !range_has_values(v)) {
        return Some(format!("the range of `{}` is not that of its enumeration", v.name));
    }
    let spot = WellFormedScope { program, automaton: a, id: Some(id) };
    if a.locations.iter().any(|l| l.invariant.iter().any(|c| !spot.clocks_exist(c))) {
        return Some("an invariant has an unknown clock".into());
    }
    if a.locations.iter().flat_map(|l| &l.stopped).any(|c| !spot.clock_exists(*c)) {
        return Some("an unknown clock stands still".into());
    }
    let of_locations = a.locations.iter().flat_map(|l| l.invariant.iter().flat_map(|c| terms(&c.bound)));
    if of_locations
        .chain(a.locations.iter().filter_map(|l| l.holds.as_ref()))
        .any(|e| !spot.functions_exist(e))
    {
        return Some("an invariant calls an unknown function".into());
    }
    for (i, e) in a.edges.iter().enumerate() {
        if !known(e.from) || !known(e.to) {
            return Some(format!("edge {i} has an unknown location"));
        }
        if e.clock_guard.iter().any(|c| !spot.clocks_exist(c)) {
            return Some(format!("edge {i} has an unknown clock"));
        }
        if !e.updates.iter().all(|u| spot.update_exists(u)) {
            return Some(format!("edge {i} updates an unknown variable or clock"));
        }
        if !spot.sync_exists(&e.sync) {
            return Some(format!("edge {i} has an unknown event or channel or a wrong number of arguments"));
        }
        let guards = e.guard.iter().chain(e.clock_guard.iter().flat_map(|c| terms(&c.bound)));
        if guards.chain(e.sync.given()).any(|e| !spot.functions_exist(e)) {
            return Some(format!("edge {i} calls an unknown function"));
        }
    }
    program
        .functions
        .iter()
        .find(|f| !spot.function_is_sound(f))
        .map(|f| format!("the function `{}` calls or assigns what is not there", f.name))
}

fn range_is_sound(v: &AutomatonVar) -> bool {
    v.lo <= v.init && v.init <= v.hi
}

/// Whether the range is that of the enumeration's indices, if there is one: then no symbol can leave it.
fn range_has_values(v: &AutomatonVar) -> bool {
    v.enumeration.is_none_or(|e| v.lo == 0 && i64::try_from(e.values().len()) == Ok(v.hi.saturating_add(1)))
}

fn terms(time: &TimeSum) -> impl Iterator<Item = &Expr> {
    time.terms.iter().map(|t| &t.value)
}

/// Where names are looked up.
struct WellFormedScope<'p> {
    program: &'p Program,
    automaton: &'p Automaton,
    /// Whose functions are known, besides those without owner.
    id: Option<AutomatonId>,
}

impl WellFormedScope<'_> {
    fn clock_exists(&self, clock: ClockId) -> bool {
        usize::from(clock.0) < self.program.clocks.len() + self.automaton.clocks.len()
    }

    fn clocks_exist(&self, c: &ClockConstraint) -> bool {
        self.clock_exists(c.clock) && c.minus.is_none_or(|m| self.clock_exists(m))
    }

    fn update_exists(&self, update: &EdgeAssignment) -> bool {
        match update {
            EdgeAssignment::Assign { place, value } => {
                place_is_within(place, self.program.shared.len() + self.automaton.vars.len())
                    && place.indices.iter().all(|i| self.functions_exist(&i.at))
                    && self.functions_exist(value)
            }
            EdgeAssignment::Reset { clock, from, to } => {
                self.clock_exists(*clock)
                    && from.is_none_or(|f| self.clock_exists(f))
                    && terms(to).all(|e| self.functions_exist(e))
            }
            EdgeAssignment::Call { function, args } => {
                self.call_exists(usize::from(function.0), args.len())
                    && args.iter().all(|e| self.functions_exist(e))
            }
        }
    }

    fn sync_exists(&self, sync: &SyncLabel) -> bool {
        let events = &self.program.events;
        let arity = |event: &hrdsl_ir::EventId| events.get(usize::from(event.0)).map(|e| e.params.len());
        match sync {
            SyncLabel::Internal => true,
            SyncLabel::Send { event, args } => arity(event) == Some(args.len()),
            SyncLabel::Receive { event, args } => arity(event) == Some(args.len()),
            SyncLabel::Offer { channel, args } => self.channel_fits(*channel, args.len(), false),
            SyncLabel::Accept { channel, args } => self.channel_fits(*channel, args.len(), false),
            SyncLabel::Join { channel } => self.channel_fits(*channel, 0, true),
        }
    }

    fn channel_fits(&self, channel: ChannelId, args: usize, multiway: bool) -> bool {
        self.program.channels.get(usize::from(channel.0)).is_some_and(|c| {
            let is_multiway = match &c.kind {
                ChannelKind::MultiWay(participants) => {
                    participants.iter().any(|p| Some(p.automaton) == self.id) && c.params.is_empty()
                }
                ChannelKind::Binary | ChannelKind::Broadcast => false,
            };
            is_multiway == multiway && c.params.len() == args && c.params.iter().all(range_has_values)
        })
    }

    fn call_exists(&self, function: usize, args: usize) -> bool {
        let known =
            |f: &AutomatonFunction| f.params.len() == args && (f.owner.is_none() || f.owner == self.id);
        self.program.functions.get(function).is_some_and(known)
    }

    fn functions_exist(&self, e: &Expr) -> bool {
        let all = |es: &[Expr]| es.iter().all(|e| self.functions_exist(e));
        match e {
            Expr::Const(_) | Expr::Var(_) => true,
            Expr::Unary(_, a) => self.functions_exist(a),
            Expr::Binary(_, a, b) => self.functions_exist(a) && self.functions_exist(b),
            Expr::If(c, a, b) => [c, a, b].iter().all(|e| self.functions_exist(e)),
            Expr::Call(_, args) => all(args),
            Expr::List(elements, rest) => {
                all(elements) && rest.as_ref().is_none_or(|r| self.functions_exist(r))
            }
            Expr::Element(place) => place.indices.iter().all(|i| self.functions_exist(&i.at)),
            Expr::Apply(f, args) => self.call_exists(usize::from(f.0), args.len()) && all(args),
        }
    }

    fn function_is_sound(&self, f: &AutomatonFunction) -> bool {
        let owner = match f.owner {
            None => Some(0),
            Some(a) => self.program.automata.get(usize::from(a.0)).map(|a| a.vars.len()),
        };
        let Some(own) = owner else { return false };
        let count = self.program.shared.len() + own + f.params.len() + f.locals.len();
        let vars = f.params.iter().chain(&f.locals).chain(&f.result);
        vars.into_iter().all(range_has_values)
            && f.locals.iter().all(range_is_sound)
            && f.body.iter().all(|s| WellFormedScope { id: f.owner, ..*self }.statement_exists(s, count))
    }

    fn statement_exists(&self, s: &FunctionStatement, count: usize) -> bool {
        let block = |all: &[FunctionStatement]| all.iter().all(|s| self.statement_exists(s, count));
        match s {
            FunctionStatement::Assign { place, value } => {
                place_is_within(place, count)
                    && place.indices.iter().all(|i| self.functions_exist(&i.at))
                    && self.functions_exist(value)
            }
            FunctionStatement::Call { function, args } => {
                self.call_exists(usize::from(function.0), args.len())
                    && args.iter().all(|e| self.functions_exist(e))
            }
            FunctionStatement::If { condition, then, otherwise } => {
                self.functions_exist(condition) && block(then) && block(otherwise)
            }
            FunctionStatement::While { condition, body } => self.functions_exist(condition) && block(body),
            FunctionStatement::For { slot, lo, hi, body } => {
                usize::from(*slot) < count
                    && self.functions_exist(lo)
                    && self.functions_exist(hi)
                    && block(body)
            }
            FunctionStatement::Return(value) => value.as_ref().is_none_or(|v| self.functions_exist(v)),
        }
    }
}

/// Whether each element of an lvalue is one of so many variables.
fn place_is_within(place: &Lvalue, count: usize) -> bool {
    let last = place.indices.iter().map(|i| usize::from(i.count.saturating_sub(1)) * usize::from(i.stride));
    place.indices.iter().all(|i| i.count > 0) && usize::from(place.slot) + last.sum::<usize>() < count
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn each_element_of_a_place_counts() {
        let at = |count, stride| hrdsl_ir::expr::ArrayIndex { at: Expr::int(0), count, stride };
        let place = Lvalue { slot: 2, indices: vec![at(3, 4), at(4, 1)] };
        assert!(place_is_within(&place, 14) && !place_is_within(&place, 13));
        assert!(!place_is_within(&Lvalue { slot: 0, indices: vec![at(0, 1)] }, 9));
    }
}
