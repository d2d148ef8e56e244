//! What all reports say about model coverage: headings and tallies, and the explanation of a suite as text.

use std::fmt::Write as _;

use hrdsl_results::CoverItemKind;

use super::text;
use hrdsl_results::{
    AgentCoverage, KindCoverage, ModelCoverage, SuiteExplanation, SuiteGoalId, TestExplanation,
};

/// Goals that are listed for a test, at most.
const LISTED: usize = 12;

/// The heading of a narrow column.
pub fn short(kind: CoverItemKind) -> &'static str {
    match kind {
        CoverItemKind::Selected => "plans",
        CoverItemKind::Completed => "done",
        CoverItemKind::Failed => "failed",
        CoverItemKind::ContextTrue => "true",
        CoverItemKind::ContextFalse => "false",
        CoverItemKind::Applicable => "choices",
        CoverItemKind::Message => "messages",
        CoverItemKind::Edge => "edges",
        CoverItemKind::Path => "paths",
    }
}

/// `5/6`; a dash if there is nothing to reach.
pub fn ratio(tally: KindCoverage) -> String {
    if tally.all == 0 { "–".to_owned() } else { format!("{}/{}", tally.reached, tally.all) }
}

/// The kinds of which an agent of the suite has items.
pub fn kinds(model: &ModelCoverage) -> Vec<CoverItemKind> {
    let has = |kind: &CoverItemKind| model.agents.iter().any(|a| of(a, *kind).all > 0);
    CoverItemKind::ALL.into_iter().filter(has).collect()
}

/// An agent's tally of a kind.
pub fn of(agent: &AgentCoverage, kind: CoverItemKind) -> KindCoverage {
    let none = KindCoverage { kind, reached: 0, all: 0 };
    agent.kinds.iter().find(|k| k.kind == kind).copied().unwrap_or(none)
}

/// What a suite's tests are for, what of the model was not reached, and why: as plain text.
#[must_use]
pub fn explain_text(suite: &str, explanation: &SuiteExplanation, coverage: Option<&ModelCoverage>) -> String {
    let mut out = String::new();
    let _ = writeln!(out, "{}", text::line(suite));
    if let Some(model) = coverage {
        tallies(&mut out, model);
    }
    if !explanation.tests.is_empty() {
        out.push_str("\nTests\n");
    }
    for test in &explanation.tests {
        one_test(&mut out, test);
    }
    let reasons = |out: &mut String, heading: &str, all: &[(String, &str)]| {
        if !all.is_empty() {
            let _ = writeln!(out, "\n{heading}");
        }
        for (name, reason) in all {
            let _ = writeln!(out, "  {}\n      {}", text::line(name), text::line(reason));
        }
    };
    let goals: Vec<(String, &str)> =
        explanation.uncovered.iter().map(|u| (u.goal.to_string(), u.reason.as_str())).collect();
    reasons(&mut out, "Goals that no test reaches", &goals);
    for agent in coverage.iter().flat_map(|m| &m.agents) {
        let is_goal = |item: &SuiteGoalId| explanation.uncovered.iter().any(|u| u.goal == *item);
        let others = agent.unreached.iter().filter(|u| !is_goal(&u.item));
        let others: Vec<(String, &str)> = others.map(|u| (u.item.to_string(), u.reason.as_str())).collect();
        reasons(&mut out, &format!("What else of {} was not reached", text::line(&agent.agent)), &others);
    }
    out
}

fn tallies(out: &mut String, model: &ModelCoverage) {
    let _ = writeln!(
        out,
        "  {} of {} reached in {}",
        model.goals_reached,
        text::count(model.goals, "goal"),
        text::count(model.runs, "run")
    );
    for agent in &model.agents {
        let all: Vec<String> =
            kinds(model).into_iter().map(|k| format!("{} {}", k.title(), ratio(of(agent, k)))).collect();
        let _ = writeln!(out, "  {}: {}", text::line(&agent.agent), all.join(", "));
    }
}

fn one_test(out: &mut String, test: &TestExplanation) {
    let goals = text::count(test.reaches, "goal");
    let _ = writeln!(out, "  {}  reaches {goals}", text::line(&test.test));
    for line in &test.because {
        let _ = writeln!(out, "      from {}", text::line(line));
    }
    for (what, goals) in [("first", &test.first), ("alone", &test.only)] {
        if goals.is_empty() {
            continue;
        }
        let mut names: Vec<String> = goals.iter().take(LISTED).map(|g| text::line(&g.to_string())).collect();
        if goals.len() > LISTED {
            names.push(format!("{} more", goals.len() - LISTED));
        }
        let _ = writeln!(out, "      {what}: {}", names.join("; "));
    }
}

#[cfg(test)]
mod tests {
    use super::{super::fixture, *};

    #[test]
    fn the_text_says_all() {
        let (coverage, explanation) = fixture::model();
        let expected = "bdi_tests
  3 of 5 goals reached in 2 runs
  Human: plans selected 2/3, completed 1/2, edges 1/2

Tests
  bdi_tests.t001  reaches 2 goals
      from wants(0)
      first: plan Human.table#1; plan Human.leg#1
  bdi_tests.t002  reaches 2 goals
      from wants(1)
      first: bin human_robot.1 leg, released
      alone: bin human_robot.1 leg, released

Goals that no test reaches
  plan Human.leg#2
      `+!leg` came twice: twice a plan before it was selected (`leg#1` twice)
  bin human_robot.4 legs, bored
      `asked` was 0, 1, needs 4

What else of Human was not reached
  plan Human.leg#1 completed
      it was selected twice and failed twice
  edge Human.table#1 -> leg#2 (step 1)
      for this step others were selected (`leg#1` twice)
";
        assert_eq!(explain_text("bdi_tests", &explanation, Some(&coverage)), expected);
    }

    #[test]
    fn hostile_text_stays_on_its_line() {
        let (_, mut explanation) = fixture::model();
        explanation.uncovered[0].goal = SuiteGoalId::Query("a\u{1b}[31m\nb".into());
        let text = explain_text("s", &explanation, None);
        assert!(text.contains("\n  query a b\n") && !text.contains('\u{1b}'));
    }
}
