//! What is to be decided: names on the command line, and queries that the scenario does not have.

use hrdsl_compiler::{CompilationResult, InputFile, ast, compile_with};
use hrdsl_ir::{Program, ta::Network};
use hrdsl_runtime::prove::is_decided_with_others;
use hrdsl_source::{FileId, Span};

use super::{
    ProveArgs,
    job::{ProofJob, ProofTarget},
};
use crate::{fault::CommandFault, files, reach::DiskModules};

/// A scenario with the queries of the command line.
pub struct QueriedScenario {
    pub compilation: CompilationResult,
    /// The names of the queries that were added.
    added: Vec<String>,
}

impl QueriedScenario {
    /// Compiles the scenario with `--ask`ed queries at its end, so that what is wrong with them is said of them.
    ///
    /// # Errors
    /// A file that cannot be read, or no network to ask.
    pub fn load(args: &ProveArgs) -> Result<Self, CommandFault> {
        let mut text = files::read_scenario(&args.file)?;
        let name = args.file.display().to_string();
        let plain =
            compile_with(InputFile { name: &name, text: &text }, &[], &DiskModules::of(Some(&args.file)));
        if args.ask.is_empty() {
            return Ok(Self { compilation: plain, added: Vec::new() });
        }
        let Some(networks) = plain.program.as_ref().map(|p| asked_networks(args, p)).transpose()? else {
            return Ok(Self { compilation: plain, added: Vec::new() });
        };
        let taken = names(&plain);
        let (mut added, mut asked) = (Vec::new(), AskedText { whole: text.len(), ..AskedText::default() });
        for network in networks {
            for ask in &args.ask {
                let name =
                    (1..).map(|n| format!("ask{n}")).find(|n| !taken.contains(n) && !added.contains(n));
                let name = name.unwrap_or_default();
                text += &format!("\nquery {name} of {network} = ");
                asked.add(&one_line(ask), &mut text);
                added.push(name);
            }
        }
        text.push('\n');
        let mut compilation =
            compile_with(InputFile { name: &name, text: &text }, &[], &DiskModules::of(Some(&args.file)));
        asked.own_what_is_said(&mut compilation);
        Ok(Self { compilation, added })
    }

    /// All that is to be decided, network by network.
    ///
    /// # Errors
    /// A name that does not exist.
    pub fn jobs(&self, args: &ProveArgs, program: &Program) -> Result<Vec<ProofJob>, CommandFault> {
        known("requirement", &args.requirement, program.monitors.iter().map(|m| m.name.as_str()))?;
        known("query", &args.query, program.queries.iter().map(|q| q.name.as_str()))?;
        let some = !args.requirement.is_empty() || !args.query.is_empty() || !args.ask.is_empty();
        let mut jobs = Vec::new();
        for (network, _) in chosen(args, program)? {
            for (monitor, m) in program.monitors.iter().enumerate() {
                if args.requirement.contains(&m.name) || !some {
                    jobs.push(ProofJob { network, what: ProofTarget::Requirement(monitor) });
                }
            }
            let wanted = |(_, q): &(usize, &hrdsl_ir::ta::Query)| {
                let named = args.query.contains(&q.name) || self.added.contains(&q.name) || !some;
                named && usize::from(q.network.0) == network
            };
            let queries = program.queries.iter().enumerate().filter(wanted);
            let (joint, alone): (Vec<_>, Vec<_>) = queries.partition(|(_, q)| is_decided_with_others(q));
            let joint: Vec<usize> = joint.into_iter().map(|(query, _)| query).collect();
            let alone = alone.into_iter().map(|(query, _)| vec![query]);
            let groups = std::iter::once(joint).chain(alone).filter(|group| !group.is_empty());
            jobs.extend(groups.map(|group| ProofJob { network, what: ProofTarget::Queries(group) }));
        }
        Ok(jobs)
    }
}

/// The queries of the command line as a file of their own, so that what is said of them has a place that the reader knows.
#[derive(Default)]
struct AskedText {
    /// How long the scenario is without them.
    whole: usize,
    text: String,
    /// Where each begins behind the scenario, where in the file of its own, and how long it is.
    places: Vec<(usize, usize, usize)>,
}

impl AskedText {
    /// Adds a query to the scenario's text.
    fn add(&mut self, ask: &str, text: &mut String) {
        self.places.push((text.len(), self.text.len(), ask.len()));
        text.push_str(ask);
        self.text += ask;
        self.text.push('\n');
    }

    /// Has what is said of the queries speak of their own file.
    fn own_what_is_said(self, compilation: &mut CompilationResult) {
        let file = compilation.files.add("--ask", self.text.as_str());
        for diagnostic in &mut compilation.diagnostics {
            let labels = diagnostic.labels.iter_mut().map(|label| &mut label.span);
            let edits = diagnostic.fixes.iter_mut().flat_map(|fix| &mut fix.edits).map(|edit| &mut edit.span);
            labels.chain(edits).for_each(|span| self.own(span, file));
        }
    }

    fn own(&self, span: &mut Span, file: FileId) {
        let Span { file: of, start, end } = *span;
        let (start, end) = (start as usize, end as usize);
        if of != FileId(0) || start < self.whole {
            return;
        }
        let before = self.places.partition_point(|(begins, _, _)| *begins <= start).saturating_sub(1);
        let Some(&(begins, at, length)) = self.places.get(before) else { return };
        let place = |byte: usize| at + byte.saturating_sub(begins).min(length);
        *span = Span::new(file, place(start), place(end));
    }
}

/// A line break would end the query where it is written, and a comment would hide what follows.
fn one_line(ask: &str) -> String {
    ask.split_whitespace().collect::<Vec<_>>().join(" ")
}

fn chosen<'p>(args: &ProveArgs, program: &'p Program) -> Result<Vec<(usize, &'p Network)>, CommandFault> {
    known("network", &args.network, program.networks.iter().map(|n| n.name.as_str()))?;
    let all = program.networks.iter().enumerate();
    let chosen: Vec<_> =
        all.filter(|(_, n)| args.network.is_empty() || args.network.contains(&n.name)).collect();
    if chosen.is_empty() {
        return Err("the scenario has no network to search".to_owned());
    }
    Ok(chosen)
}

/// The networks that `--ask` is about.
fn asked_networks(args: &ProveArgs, program: &Program) -> Result<Vec<String>, CommandFault> {
    let chosen = chosen(args, program)?;
    if args.network.is_empty() && chosen.len() > 1 {
        let names: Vec<&str> = chosen.iter().map(|(_, n)| n.name.as_str()).collect();
        return Err(format!("say which network to ask with --network: {}", names.join(", ")));
    }
    Ok(chosen.into_iter().map(|(_, n)| n.name.clone()).collect())
}

/// The names of the queries that there are.
fn names(compilation: &CompilationResult) -> Vec<String> {
    let items = compilation.ast.iter().flat_map(|f| &f.items);
    let query = |i: &ast::ItemSyntax| {
        if let ast::ItemSyntaxKind::Query(q) = &i.kind { Some(q.name.text.clone()) } else { None }
    };
    items.filter_map(query).collect()
}

fn known<'n>(what: &str, wanted: &[String], all: impl Iterator<Item = &'n str>) -> Result<(), CommandFault> {
    let all: Vec<&str> = all.collect();
    for name in wanted {
        if !all.contains(&name.as_str()) {
            let has = if all.is_empty() { "none".to_owned() } else { all.join(", ") };
            return Err(format!("no {what} `{name}`; the scenario has: {has}"));
        }
    }
    Ok(())
}
