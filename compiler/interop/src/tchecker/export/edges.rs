//! Edges with constant arguments: one for each combination of the selects and of what is sent or taken.

use hrdsl_ir::{
    ArgPattern, Expr, Type, Value,
    ta::{AutomatonVar, ChannelKind, Edge, ReceiveArg, SyncLabel},
};

use super::{TcheckerWriter, expr::TcheckerExprWriter, expr::number};
use crate::exchange::obstacle::ExportObstacle;

/// The most edges that one edge may become.
const MAX_INSTANCES: usize = 4_096;

/// An edge as TChecker has them.
#[derive(Clone)]
pub struct EdgeInstance {
    pub from: usize,
    pub to: usize,
    pub event: String,
    pub guard: Vec<String>,
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

/// A medium's name, the values of each of its parameters, and what an edge says of them.
type MediumUse<'e> = (String, Vec<Vec<Value>>, Vec<MediumArgument<'e>>);

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
            let mut chosen: Vec<Vec<Value>> = vec![Vec::new()];
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
        binders: &[Value],
        out: &mut Vec<EdgeInstance>,
    ) -> Result<(), String> {
        let (name, domains, args) = self.medium(edge)?;
        let mut all: Vec<Vec<Value>> = vec![Vec::new()];
        for (domain, arg) in domains.iter().zip(&args) {
            let constant = match arg {
                MediumArgument::Sent(e) => self.constant(a, e, binders),
                MediumArgument::Taken(ReceiveArg::Match(ArgPattern::Is(v))) => Some(*v),
                MediumArgument::Taken(ReceiveArg::Match(ArgPattern::Any) | ReceiveArg::Bind) => None,
            };
            all = match constant {
                Some(v) => crossed(all, &[v]),
                None => crossed(all, domain),
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
    fn constant(&self, a: usize, e: &Expr, bound: &[Value]) -> Option<Value> {
        let known = self.program.shared.len() + self.automata[a].vars.len();
        e.eval(&|slot| bound.get(usize::from(slot).checked_sub(known)?).copied()).ok()
    }

    /// The medium of an edge: its name, the values of each parameter, what the edge says of them.
    fn medium<'e>(&self, edge: &'e Edge) -> Result<MediumUse<'e>, String> {
        let event = |id: &hrdsl_ir::EventId| {
            let event = self.program.event(*id);
            let domains = event.params.iter().map(|p| domain(&event.name, &p.name, p.ty));
            Ok::<_, String>((event.name.clone(), domains.collect::<Result<Vec<_>, _>>()?))
        };
        let channel = |id: &hrdsl_ir::ta::ChannelId| {
            let channel = &self.program.channels[usize::from(id.0)];
            (channel.name.clone(), channel.params.iter().map(values).collect())
        };
        let sent = |args: &'e [Expr]| args.iter().map(MediumArgument::Sent).collect();
        let taken = |args: &[ReceiveArg]| args.iter().map(|a| MediumArgument::Taken(*a)).collect();
        Ok(match &edge.sync {
            SyncLabel::Internal => (String::new(), Vec::new(), Vec::new()),
            SyncLabel::Send { event: e, args } => {
                let (name, domains) = event(e)?;
                (name, domains, sent(args))
            }
            SyncLabel::Receive { event: e, args } => {
                let (name, domains) = event(e)?;
                (name, domains, taken(args))
            }
            SyncLabel::Offer { channel: c, args } => {
                let (name, domains) = channel(c);
                (name, domains, sent(args))
            }
            SyncLabel::Accept { channel: c, args } => {
                let (name, domains) = channel(c);
                (name, domains, taken(args))
            }
            SyncLabel::Join { channel: c } => (channel(c).0, Vec::new(), Vec::new()),
        })
    }

    /// `take_1_0`
    fn flat(&self, name: &str, values: &[Value]) -> Result<String, String> {
        let mut flat = name.to_owned();
        for v in values {
            let text = number(self.program, *v)?;
            flat += &format!("_{}", text.trim_matches(['(', ')']).replace('-', "m"));
        }
        Ok(flat)
    }

    fn instance(
        &mut self,
        a: usize,
        edge: &Edge,
        bound: &[Value],
        equal: &[(&Expr, Value)],
        flat: String,
    ) -> Result<EdgeInstance, String> {
        let exprs = TcheckerExprWriter::new(self.program, &self.names, a, self.unit, bound);
        let mut guard: Vec<String> =
            edge.clock_guard.iter().map(|c| exprs.bound(c)).collect::<Result<_, _>>()?;
        if let Some(e) = &edge.guard
            && self.constant(a, e, bound).is_none()
        {
            guard.extend(exprs.conjunction(e)?);
        }
        for (e, value) in equal {
            guard.push(format!("({})=={}", exprs.int(e, 0)?, number(self.program, *value)?));
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
                let message =
                    format!("the channel `{}` is urgent: TChecker has no urgent channels", channel.name);
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

fn crossed(all: Vec<Vec<Value>>, values: &[Value]) -> Vec<Vec<Value>> {
    let with = |start: &Vec<Value>, v: &Value| {
        let mut longer = start.clone();
        longer.push(*v);
        longer
    };
    // One too many is enough to see that there are too many.
    let pairs = all.iter().flat_map(|start| values.iter().map(move |v| (start, v)));
    pairs.take(MAX_INSTANCES + 1).map(|(start, v)| with(start, v)).collect()
}

fn values(var: &AutomatonVar) -> Vec<Value> {
    let most = i64::try_from(MAX_INSTANCES).unwrap_or(i64::MAX);
    (var.lo..=var.hi.min(var.lo.saturating_add(most))).filter_map(|n| var.value(n)).collect()
}

fn domain(event: &str, param: &str, ty: Type) -> Result<Vec<Value>, String> {
    match ty {
        Type::Bool | Type::Int { .. } | Type::Enum(_) => Ok(ty.domain().unwrap_or_default()),
        Type::Float(_) | Type::Text | Type::List(_) => {
            Err(format!("the parameter `{param}` of `{event}` is of a type that TChecker has not"))
        }
    }
}
