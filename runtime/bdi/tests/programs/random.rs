//! Random societies: agents that share names of beliefs and goals, speak to each other, wait, fork and fail.

use hrdsl_ir::{
    Actor, ActorId, ArgPattern, Event, EventId, EventPattern, Expr, Parameter, Program, Role, Span, Symbol,
    Type, Value,
    bdi::{
        Agent, AgentTerm, Assertion, BeliefAnnotation, BeliefDecl, BeliefId, BeliefLiteral, ContentId,
        ControlAct, GoalDecl, GoalId, InitialFact, InternalAct, MessageContent, MessageSubject, Performative,
        Plan, PlanContext, PlanStep, PlanStepKind, PlanTrigger, TriggerOn,
    },
    expr::BinaryOp,
};
use rand::{RngExt, SeedableRng, seq::IndexedRandom};
use rand_chacha::ChaCha8Rng;

const BELIEFS: u16 = 3;
const GOALS: u16 = 3;
const EVENTS: u16 = 3;
const VARS: u16 = 4;
const INT: Type = Type::Int { lo: -6, hi: 6 };

struct Maker {
    rng: ChaCha8Rng,
    agents: u16,
    /// The variables that surely have a value.
    bound: Vec<u16>,
}

/// A program of so many agents.
pub fn society(seed: u64, agents: u16) -> Program {
    let mut maker = Maker { rng: ChaCha8Rng::seed_from_u64(seed), agents, bound: Vec::new() };
    let param = || Parameter { name: "p".to_owned(), ty: INT };
    let actor = |n: u16| Actor {
        name: format!("actor{n}"),
        role: if n == 0 { Role::System } else { Role::Environment },
        origin: Span::default(),
    };
    let event = |n: u16| Event {
        name: format!("e{n}"),
        params: vec![param()],
        from: ActorId(n % agents),
        to: Vec::new(),
        stimulus: None,
        origin: Span::default(),
    };
    let subjects = |subject: MessageSubject| vec![Some(subject); usize::from(agents)];
    let beliefs = (0..BELIEFS)
        .map(|b| MessageContent { name: format!("b{b}"), of: subjects(MessageSubject::Belief(BeliefId(b))) });
    let goals = (0..GOALS)
        .map(|g| MessageContent { name: format!("g{g}"), of: subjects(MessageSubject::Goal(GoalId(g))) });
    Program {
        actors: (0..agents).map(actor).collect(),
        events: (0..EVENTS * agents).map(event).collect(),
        agents: (0..agents).map(|n| maker.agent(n)).collect(),
        contents: beliefs.chain(goals).collect(),
        ..Program::default()
    }
}

impl Maker {
    fn agent(&mut self, number: u16) -> Agent {
        let param = || Parameter { name: "p".to_owned(), ty: INT };
        let belief = |b: u16| BeliefDecl {
            negates: None,
            name: format!("b{b}"),
            params: vec![param()],
            annotations: Vec::new(),
            percept: None,
            origin: Span::default(),
        };
        let goal = |g: u16| GoalDecl { name: format!("g{g}"), arity: 1, params: None };
        let fact = |belief, n| InitialFact { belief, args: vec![Value::Int(n)], annotations: Vec::new() };
        let plans = self.rng.random_range(4..12);
        Agent {
            name: format!("agent{number}"),
            actor: ActorId(number),
            beliefs: (0..BELIEFS).map(belief).collect(),
            goals: (0..GOALS).map(goal).collect(),
            rules: Vec::new(),
            jason: false,
            initial_beliefs: (0..3).map(|_| fact(self.belief(), self.rng.random_range(-3..4))).collect(),
            initial_goals: vec![(GoalId(0), vec![Value::Int(i64::from(number))])],
            plans: (0..plans).map(|at| self.plan(number, at)).collect(),
            origin: Span::default(),
        }
    }

    fn belief(&mut self) -> BeliefId {
        BeliefId(self.rng.random_range(0..BELIEFS))
    }

    fn plan(&mut self, of: u16, at: u16) -> Plan {
        let goal = GoalId(self.rng.random_range(0..GOALS));
        let on = match self.rng.random_range(0..9) {
            _ if at < 3 => TriggerOn::GoalAdded(GoalId(at)),
            0..4 => TriggerOn::GoalAdded(goal),
            4 => TriggerOn::GoalFailed(goal),
            5 => TriggerOn::BeliefAdded(self.belief()),
            6 => TriggerOn::BeliefRemoved(self.belief()),
            7 => TriggerOn::TestAdded(self.belief()),
            _ => TriggerOn::Perceived(self.event(None)),
        };
        self.bound = vec![0];
        let context = if at < 3 { PlanContext::True } else { self.context() };
        let steps = self.rng.random_range(0..5);
        let body = self.steps(of, steps, 2);
        Plan {
            label: format!("p{at}"),
            atomic: self.rng.random_ratio(1, 12),
            trigger: PlanTrigger {
                name: Span::default(),
                origin: Span::default(),
                on,
                args: vec![AgentTerm::Var(0)],
                annotations: Vec::new(),
            },
            context,
            body,
            vars: (0..VARS).map(|v| format!("V{v}")).collect(),
            origin: Span::default(),
        }
    }

    /// An event, of this agent's actor if it is to make it.
    fn event(&mut self, of: Option<u16>) -> EventId {
        let by = of.unwrap_or_else(|| self.rng.random_range(0..self.agents));
        EventId(by + self.agents * self.rng.random_range(0..EVENTS))
    }

    fn expr(&mut self) -> Expr {
        let n = self.rng.random_range(-3..4);
        match self.bound.choose(&mut self.rng).copied() {
            Some(v) if self.rng.random_ratio(2, 3) => Expr::binary(BinaryOp::Add, Expr::Var(v), Expr::int(n)),
            _ => Expr::int(n),
        }
    }

    /// An argument of a goal: one that is open gets its value from the goal, or none.
    fn wanted(&mut self) -> Expr {
        if !self.rng.random_bool(0.05) {
            return self.expr();
        }
        let var = self.rng.random_range(0..VARS);
        if !self.bound.contains(&var) {
            self.bound.push(var);
        }
        Expr::Var(var)
    }

    /// A term that may bind a variable, which is bound from then on if that is wanted.
    fn term(&mut self, binds: bool) -> AgentTerm {
        match self.rng.random_range(0..3) {
            0 => AgentTerm::Any,
            1 => AgentTerm::Expr(self.expr()),
            _ => {
                let var = self.rng.random_range(0..VARS);
                if binds && !self.bound.contains(&var) {
                    self.bound.push(var);
                }
                AgentTerm::Var(var)
            }
        }
    }

    fn literal(&mut self, binds: bool) -> BeliefLiteral {
        let annotations = if self.rng.random_ratio(1, 5) {
            vec![(BeliefAnnotation::Source, AgentTerm::Any)]
        } else {
            Vec::new()
        };
        BeliefLiteral {
            origin: Span::default(),
            belief: self.belief(),
            args: vec![self.term(binds)],
            annotations,
        }
    }

    fn context(&mut self) -> PlanContext {
        match self.rng.random_range(0..6) {
            0 => PlanContext::True,
            1 => PlanContext::Not(Box::new(PlanContext::Belief(self.literal(false)))),
            2 => PlanContext::Test(Expr::binary(BinaryOp::Lt, self.expr(), self.expr())),
            3 => PlanContext::And(vec![PlanContext::Belief(self.literal(true)), self.context()]),
            4 => {
                let formula = PlanContext::Belief(self.literal(false));
                let count = InternalAct::Count { formula, out: self.term(true) };
                PlanContext::Internal(Box::new(count), Span::default())
            }
            _ => PlanContext::Belief(self.literal(true)),
        }
    }

    fn steps(&mut self, of: u16, count: usize, depth: u32) -> Vec<PlanStep> {
        (0..count).map(|_| PlanStep { kind: self.step(of, depth), origin: Span::default() }).collect()
    }

    /// A block's steps bind nothing for those behind it.
    fn block(&mut self, of: u16, depth: u32) -> Vec<PlanStep> {
        let before = self.bound.clone();
        let count = self.rng.random_range(0..3);
        let steps = self.steps(of, count, depth - 1);
        self.bound = before;
        steps
    }

    fn step(&mut self, of: u16, depth: u32) -> PlanStepKind {
        let belief = self.belief();
        let goal = GoalId(self.rng.random_range(0..GOALS));
        let seconds = Expr::float(f64::from(self.rng.random_range(0..8)) / 2.0);
        match self.rng.random_range(0..if depth > 0 { 22 } else { 18 }) {
            0 => PlanStepKind::Do {
                event: self.event(Some(of)),
                args: vec![Expr::int(self.rng.random_range(-3..4))],
            },
            1 | 2 => {
                let within = self.rng.random_bool(0.3).then(|| seconds.clone());
                PlanStepKind::Achieve { goal, args: vec![self.wanted()], within }
            }
            3 => PlanStepKind::Spawn { goal, args: vec![self.expr()] },
            4 => PlanStepKind::Query(self.literal(true)),
            5 => PlanStepKind::Test(self.context()),
            6 => PlanStepKind::Add(Assertion { belief, args: vec![self.expr()], annotations: Vec::new() }),
            7 => PlanStepKind::Remove(self.literal(false)),
            8 => {
                PlanStepKind::Replace(Assertion { belief, args: vec![self.expr()], annotations: Vec::new() })
            }
            9 => PlanStepKind::Abolish(self.literal(false)),
            10 | 11 => {
                let pattern = EventPattern { event: self.event(None), args: vec![ArgPattern::Any] };
                let within = self.rng.random_bool(0.7).then_some(seconds);
                PlanStepKind::Await { events: vec![pattern], within }
            }
            12 | 13 => PlanStepKind::Wait { seconds },
            14 | 15 => self.message(),
            16 => self.question(seconds),
            17 => self.control(goal),
            18 => {
                let before = self.bound.clone();
                let condition = self.context();
                let then = self.block(of, depth);
                self.bound = before;
                PlanStepKind::If { condition, then, otherwise: self.block(of, depth) }
            }
            19 => {
                let before = self.bound.clone();
                let condition = self.context();
                let body = self.block(of, depth);
                self.bound = before;
                PlanStepKind::For { condition, body }
            }
            _ => {
                let all = self.rng.random_bool(0.5);
                PlanStepKind::Fork { branches: vec![self.block(of, depth), self.block(of, depth)], all }
            }
        }
    }

    fn other(&mut self) -> Expr {
        let other = self.rng.random_range(0..self.agents);
        Expr::Const(Value::Symbol(Symbol::intern(&format!("agent{other}"))))
    }

    fn message(&mut self) -> PlanStepKind {
        let performative = match self.rng.random_range(0..6) {
            0 => Performative::Untell,
            1 | 2 => Performative::Achieve,
            3 => Performative::AskOne,
            4 => Performative::AskAll,
            _ => Performative::Tell,
        };
        let is_goal = performative == Performative::Achieve;
        let content = if is_goal { BELIEFS + self.rng.random_range(0..GOALS) } else { self.belief().0 };
        let to = self.rng.random_ratio(4, 5).then(|| self.other());
        let args = vec![AgentTerm::Expr(self.expr())];
        PlanStepKind::Send { to, performative, content: ContentId(content), args, annotations: vec![] }
    }

    fn question(&mut self, seconds: Expr) -> PlanStepKind {
        let (to, content) = (self.other(), ContentId(self.belief().0));
        let var = self.rng.random_range(0..VARS);
        if !self.bound.contains(&var) {
            self.bound.push(var);
        }
        PlanStepKind::Ask { to, content, args: vec![AgentTerm::Var(var)], within: Some(seconds) }
    }

    fn control(&mut self, goal: GoalId) -> PlanStepKind {
        let all = [
            ControlAct::DropIntention,
            ControlAct::DropDesire,
            ControlAct::SucceedGoal,
            ControlAct::FailGoal,
            ControlAct::Suspend,
            ControlAct::Resume,
            ControlAct::Resume,
        ];
        let what = *all.choose(&mut self.rng).unwrap_or(&ControlAct::Resume);
        PlanStepKind::Control { what, goal: Some((goal, vec![AgentTerm::Any])) }
    }
}
