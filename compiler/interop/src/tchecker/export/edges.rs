//! Edges with constant arguments: one for each combination of the selects and of what is sent or taken.

use hrdsl_ir::{
    ArgPattern, Expr, Type, Value,
    ta::{AutomatonVar, ChannelKind, Edge, ReceiveArg, SyncLabel},
};

use super::{
    TcheckerWriter,
    expr::TcheckerExprWriter,
    value::{BoundTcheckerValue, GuardPart, number},
};
use crate::exchange::obstacle::ExportObstacle;

/// The most edges that one edge may become.
const MAX_INSTANCES: usize = 4_096;

/// An edge as TChecker has them.
#[derive(Clone)]
pub struct EdgeInstance {
    pub from: usize,
    pub to: usize,
    pub event: String,
    pub guard: Vec<GuardPart>,
    pub body: Vec<String>,
    pub part: EdgeSyncRole,
}

/// What an edge has to do with others.
#[derive(Clone, PartialEq, Eq, PartialOrd, Ord)]
pub enum EdgeSyncRole {
    Alone,
    /// With the name of the medium and its arguments.
    Offers(String),
    Accepts(String),
    Announces(String),
    Hears(String),
    /// A multi-way channel, by its index.
    Joins(usize),
}

/// A medium's name, its parameters, and what an edge says of them.
type MediumUse<'e> = (String, Vec<AutomatonVar>, Vec<MediumArgument<'e>>);

/// What an edge says about one argument.
enum MediumArgument<'e> {
    Sent(&'e Expr),
    Taken(ReceiveArg),
}

impl TcheckerWriter<'_> {
    /// The edges of an automaton.
    pub(super) fn instances(&mut self, a: usize) -> Vec<EdgeInstance> {
        let automaton = self.automata[a];
        let mut out = Vec::new();
        for edge in &automaton.edges {
            let mut chosen: Vec<Vec<BoundTcheckerValue>> = vec![Vec::new()];
            for select in &edge.selects {
                chosen = crossed(chosen, &values(select));
            }
            let before = out.len();
            for binders in chosen {
                if let Err(message) = self.with_selects(a, edge, &binders, &mut out) {
                    self.obstacles.push(ExportObstacle { message, origin: edge.origin });
                    break;
                }
                if out.len() - before > MAX_INSTANCES {
                    let message = format!("this edge becomes more than {MAX_INSTANCES} of them");
                    self.obstacles.push(ExportObstacle { message, origin: edge.origin });
                    break;
                }
            }
        }
        out
    }

    fn with_selects(
        &mut self,
        a: usize,
        edge: &Edge,
        binders: &[BoundTcheckerValue],
        out: &mut Vec<EdgeInstance>,
    ) -> Result<(), String> {
        let (name, params, args) = self.medium(edge)?;
        let mut all: Vec<Vec<BoundTcheckerValue>> = vec![Vec::new()];
        for (param, arg) in params.iter().zip(&args) {
            let constant = match arg {
                MediumArgument::Sent(e) => self.constant(a, e, binders),
                MediumArgument::Taken(ReceiveArg::Match(ArgPattern::Is(v))) => Some(*v),
                MediumArgument::Taken(ReceiveArg::Match(ArgPattern::Any) | ReceiveArg::Bind) => None,
            };
            all = match constant {
                Some(value) => crossed(all, &[BoundTcheckerValue { value, of: param.enumeration }]),
                None => crossed(all, &values(param)),
            };
        }
        for values in all {
            let mut bound = binders.to_vec();
            let mut equal = Vec::new();
            for (value, arg) in values.iter().zip(&args) {
                match arg {
                    MediumArgument::Taken(ReceiveArg::Bind) => bound.push(*value),
                    MediumArgument::Sent(e) if self.constant(a, e, binders).is_none() => {
                        equal.push((*e, *value))
                    }
                    MediumArgument::Taken(ReceiveArg::Match(_)) | MediumArgument::Sent(_) => {}
                }
            }
            let known = edge.guard.as_ref().and_then(|g| self.constant(a, g, &bound));
            if known == Some(Value::Bool(false)) {
                continue;
            }
            let flat = self.flat(&name, &values)?;
            out.push(self.instance(a, edge, &bound, &equal, flat)?);
        }
        Ok(())
    }

    /// The value of an expression that reads nothing but what the edge binds.
    fn constant(&self, a: usize, e: &Expr, bound: &[BoundTcheckerValue]) -> Option<Value> {
        let known = self.program.shared.len() + self.automata[a].vars.len();
        e.eval(&|slot| bound.get(usize::from(slot).checked_sub(known)?).map(|b| b.value)).ok()
    }

    /// The medium of an edge: its name, its parameters, what the edge says of them.
    fn medium<'e>(&self, edge: &'e Edge) -> Result<MediumUse<'e>, String> {
        let event = |id: &hrdsl_ir::EventId| {
            let event = self.program.event(*id);
            let params = event.params.iter().map(|p| param(&event.name, &p.name, p.ty));
            Ok::<_, String>((event.name.clone(), params.collect::<Result<Vec<_>, _>>()?))
        };
        let channel = |id: &hrdsl_ir::ta::ChannelId| {
            let channel = &self.program.channels[usize::from(id.0)];
            (channel.name.clone(), channel.params.clone())
        };
        let sent = |args: &'e [Expr]| args.iter().map(MediumArgument::Sent).collect();
        let taken = |args: &[ReceiveArg]| args.iter().map(|a| MediumArgument::Taken(*a)).collect();
        Ok(match &edge.sync {
            SyncLabel::Internal => (String::new(), Vec::new(), Vec::new()),
            SyncLabel::Send { event: e, args } => {
                let (name, params) = event(e)?;
                (name, params, sent(args))
            }
            SyncLabel::Receive { event: e, args } => {
                let (name, params) = event(e)?;
                (name, params, taken(args))
            }
            SyncLabel::Offer { channel: c, args } => {
                let (name, params) = channel(c);
                (name, params, sent(args))
            }
            SyncLabel::Accept { channel: c, args } => {
                let (name, params) = channel(c);
                (name, params, taken(args))
            }
            SyncLabel::Join { channel: c } => (channel(c).0, Vec::new(), Vec::new()),
        })
    }

    /// `take_1_0`
    fn flat(&self, name: &str, values: &[BoundTcheckerValue]) -> Result<String, String> {
        let mut flat = name.to_owned();
        for v in values {
            let text = number(self.program, v.value, v.of)?;
            flat += &format!("_{}", text.trim_matches(['(', ')']).replace('-', "m"));
        }
        Ok(flat)
    }

    fn instance(
        &mut self,
        a: usize,
        edge: &Edge,
        bound: &[BoundTcheckerValue],
        equal: &[(&Expr, BoundTcheckerValue)],
        flat: String,
    ) -> Result<EdgeInstance, String> {
        let exprs = TcheckerExprWriter::new(self.program, &self.names, a, self.unit, bound);
        let mut guard: Vec<GuardPart> =
            edge.clock_guard.iter().map(|c| exprs.clock_part(c)).collect::<Result<_, _>>()?;
        if let Some(e) = &edge.guard
            && self.constant(a, e, bound).is_none()
        {
            guard.extend(exprs.conjunction(e)?.into_iter().map(GuardPart::of_integers));
        }
        for (e, value) in equal {
            let number = number(self.program, value.value, value.of)?;
            guard.push(GuardPart::of_integers(format!("({})=={number}", exprs.int(e, value.of, 0)?)));
        }
        let mut body = Vec::new();
        let mut locals = Vec::new();
        let mut fresh = |name: &str| {
            locals.push(name.to_owned());
            format!("{name}_local{}", locals.len())
        };
        for u in &edge.updates {
            body.extend(exprs.update(u, &mut fresh)?);
        }
        let part = match &edge.sync {
            SyncLabel::Internal => EdgeSyncRole::Alone,
            SyncLabel::Send { .. } => EdgeSyncRole::Announces(flat),
            SyncLabel::Receive { .. } => EdgeSyncRole::Hears(flat),
            SyncLabel::Offer { channel, .. } => match self.kind(channel.0) {
                ChannelKind::Broadcast => EdgeSyncRole::Announces(flat),
                ChannelKind::Binary | ChannelKind::MultiWay(_) => EdgeSyncRole::Offers(flat),
            },
            SyncLabel::Accept { channel, .. } => match self.kind(channel.0) {
                ChannelKind::Broadcast => EdgeSyncRole::Hears(flat),
                ChannelKind::Binary | ChannelKind::MultiWay(_) => EdgeSyncRole::Accepts(flat),
            },
            SyncLabel::Join { channel } => EdgeSyncRole::Joins(usize::from(channel.0)),
        };
        if let Some(channel) = edge.sync.channel() {
            let channel = self.program.channel(channel);
            if channel.urgent {
                let message = format!(
                    "the channel `{}` is urgent, and TChecker has no urgent channels: make the locations from which it is offered urgent, if it is always accepted there",
                    channel.name
                );
                self.obstacles.push(ExportObstacle { message, origin: channel.origin });
            }
        }
        let (from, to) = (usize::from(edge.from.0), usize::from(edge.to.0));
        Ok(EdgeInstance { from, to, event: String::new(), guard, body, part })
    }

    fn kind(&self, channel: u16) -> &ChannelKind {
        &self.program.channels[usize::from(channel)].kind
    }
}

fn crossed(all: Vec<Vec<BoundTcheckerValue>>, values: &[BoundTcheckerValue]) -> Vec<Vec<BoundTcheckerValue>> {
    let with = |start: &Vec<BoundTcheckerValue>, v: &BoundTcheckerValue| {
        let mut longer = start.clone();
        longer.push(*v);
        longer
    };
    // One too many is enough to see that there are too many.
    let pairs = all.iter().flat_map(|start| values.iter().map(move |v| (start, v)));
    pairs.take(MAX_INSTANCES + 1).map(|(start, v)| with(start, v)).collect()
}

fn values(var: &AutomatonVar) -> Vec<BoundTcheckerValue> {
    let most = i64::try_from(MAX_INSTANCES).unwrap_or(i64::MAX);
    let all = (var.lo..=var.hi.min(var.lo.saturating_add(most))).filter_map(|n| var.value(n));
    all.map(|value| BoundTcheckerValue { value, of: var.enumeration }).collect()
}

fn param(event: &str, name: &str, ty: Type) -> Result<AutomatonVar, String> {
    AutomatonVar::of_type(name, ty).ok_or_else(|| {
        format!("the parameter `{name}` of `{event}` is of a type that TChecker has not: make it a range, as `0..9`")
    })
}
