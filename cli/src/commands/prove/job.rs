//! What is decided in one go: a requirement, a query, or all queries that one search answers.

use std::sync::Arc;

use hrdsl_ir::{Program, ta::QueryKind};
use hrdsl_runtime::prove::{
    self, ProofOptions, ProofStatus, QueryFinding, QueryResult, RequirementProof, SearchWatch,
};

use super::{
    clock::{ProofClock, now},
    table::{ProofRow, PropertyKind, PropertyVerdict},
};
use crate::fault::CommandFault;

/// Something to decide.
pub struct ProofJob {
    /// Index into the program's networks.
    pub network: usize,
    pub what: ProofTarget,
}

/// By their places in the program.
pub enum ProofTarget {
    Requirement(usize),
    /// One query, or all of one network that one search decides.
    Queries(Vec<usize>),
}

impl ProofJob {
    /// Decides it, and tells the clock what is known as soon as it is. `known`: what was decided before.
    ///
    /// # Errors
    /// An engine that contradicts itself, or nobody to print to.
    pub fn rows(
        &self,
        program: &Arc<Program>,
        settings: &ProofOptions,
        clock: &ProofClock,
        known: &[ProofRow],
    ) -> Result<Vec<ProofRow>, CommandFault> {
        let started = now();
        let mut told = Vec::new();
        let mut rows = match &self.what {
            ProofTarget::Requirement(monitor) => vec![self.proof(program, *monitor, settings, clock)?],
            ProofTarget::Queries(queries) => {
                self.answers(program, queries, settings, clock, (known, &mut told))?
            }
        };
        for row in &mut rows {
            row.network.clone_from(&program.networks[self.network].name);
            row.time = started.elapsed();
        }
        for row in rows.iter().filter(|row| !told.contains(&row.place)) {
            clock.tell(&row.network, row.kind, &row.name, row.verdict)?;
        }
        Ok(rows)
    }

    fn proof(
        &self,
        program: &Arc<Program>,
        monitor: usize,
        settings: &ProofOptions,
        clock: &ProofClock,
    ) -> Result<ProofRow, CommandFault> {
        let (of, settings, network) = (Arc::clone(program), *settings, self.network);
        let work =
            move |watch: &SearchWatch| prove::prove(&of, &of.networks[network], monitor, &settings, watch);
        let proof = clock.watched(&program.monitors[monitor].name, work, &mut |_| Ok(()))?;
        let late = || RequirementProof {
            monitor,
            status: ProofStatus::Inconclusive(clock.late().to_owned()),
            statistics: None,
            note: None,
        };
        let mut row = ProofRow::of_proof(program, &proof.unwrap_or_else(late));
        row.place = (network, PropertyKind::Requirement, monitor);
        Ok(row)
    }

    fn answers(
        &self,
        program: &Arc<Program>,
        queries: &[usize],
        settings: &ProofOptions,
        clock: &ProofClock,
        (known, told): (&[ProofRow], &mut Vec<(usize, PropertyKind, usize)>),
    ) -> Result<Vec<ProofRow>, CommandFault> {
        let (of, asked, settings, network) = (Arc::clone(program), queries.to_vec(), *settings, self.network);
        let mine = known.iter().filter(|row| row.place.0 == network);
        let ranges: Vec<usize> = mine.flat_map(|row| row.slots.iter().copied()).collect();
        let work = move |watch: &SearchWatch| prove::answers(&of, &asked, &settings, watch, &ranges);
        let label = match queries {
            [query] => program.queries[*query].name.clone(),
            several => format!("{} queries", several.len()),
        };
        // What is reached early is known before the others are.
        let mut early = |goal: usize| {
            let Some(&query) = queries.get(goal) else { return Ok(()) };
            let verdict = match reached(&program.queries[query].ask) {
                Some(QueryFinding::Satisfied) => PropertyVerdict::Satisfied,
                Some(_) => PropertyVerdict::NotSatisfied,
                None => return Ok(()),
            };
            told.push((network, PropertyKind::Query, query));
            let name = &program.queries[query].name;
            clock.tell(&program.networks[network].name, PropertyKind::Query, name, verdict)
        };
        let answers = clock.watched(&label, work, &mut early)?;
        // What was met before the end is known, though nobody waits for the run that shows it.
        let known = |query: usize| told.iter().any(|(_, _, q)| *q == query);
        let late = |query: &usize| {
            let reached = if known(*query) { reached(&program.queries[*query].ask) } else { None };
            let notes = reached.iter().map(|_| format!("{} before its run was made", clock.late())).collect();
            QueryResult {
                query: *query,
                found: reached.unwrap_or_else(|| QueryFinding::Inconclusive(clock.late().to_owned())),
                run: None,
                notes,
                statistics: None,
                joint: queries.len() > 1,
                ranges: Vec::new(),
            }
        };
        let answers = answers.unwrap_or_else(|| queries.iter().map(late).collect());
        let row = |answer: &QueryResult| {
            let mut row = ProofRow::of_answer(program, answer);
            row.place = (network, PropertyKind::Query, answer.query);
            row
        };
        let mut rows: Vec<ProofRow> = answers.iter().map(row).collect();
        // Answers of one search have the same of them.
        for range in answers.iter().flat_map(|answer| &answer.ranges) {
            let mut row = ProofRow::of_range(range);
            row.place.0 = network;
            if rows.iter().all(|other| other.place != row.place) {
                rows.push(row);
            }
        }
        Ok(rows)
    }
}

/// What a query is answered by as soon as its goal is met; `None`: its goal alone does not decide it.
fn reached(ask: &QueryKind) -> Option<QueryFinding> {
    match ask {
        QueryKind::Possibly(_) => Some(QueryFinding::Satisfied),
        QueryKind::Invariantly(_) => Some(QueryFinding::NotSatisfied),
        QueryKind::PotentiallyAlways(_)
        | QueryKind::Eventually(_)
        | QueryKind::LeadsTo(..)
        | QueryKind::Sup { .. }
        | QueryKind::Inf { .. } => None,
    }
}
