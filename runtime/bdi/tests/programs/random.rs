//! Random societies: agents that share names of beliefs and goals, speak to each other, wait, fork and fail.

use hrdsl_ir::{
    Actor, ActorId, ArgPattern, Event, EventId, EventPattern, Expr, Param, Program, Role, Span, Symbol, Type,
    Value,
    bdi::{
        Agent, Annotation, Assertion, Belief, BeliefId, Content, ContentId, Context, Control, Fact, Goal,
        GoalId, Internal, Literal, Performative, Plan, Step, StepKind, Subject, Term, Trigger, TriggerOn,
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
    let param = || Param { name: "p".to_owned(), ty: INT };
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
    let subjects = |subject: Subject| vec![Some(subject); usize::from(agents)];
    let beliefs =
        (0..BELIEFS).map(|b| Content { name: format!("b{b}"), of: subjects(Subject::Belief(BeliefId(b))) });
    let goals = (0..GOALS).map(|g| Content { name: format!("g{g}"), of: subjects(Subject::Goal(GoalId(g))) });
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
        let param = || Param { name: "p".to_owned(), ty: INT };
        let belief = |b: u16| Belief {
            negates: None,
            name: format!("b{b}"),
            params: vec![param()],
            annotations: Vec::new(),
            percept: None,
            origin: Span::default(),
        };
        let goal = |g: u16| Goal { name: format!("g{g}"), arity: 1, params: None };
        let fact = |belief, n| Fact { belief, args: vec![Value::Int(n)], annotations: Vec::new() };
        let plans = self.rng.random_range(4..12);
        Agent {
            name: format!("agent{number}"),
            actor: ActorId(number),
            beliefs: (0..BELIEFS).map(belief).collect(),
            goals: (0..GOALS).map(goal).collect(),
            rules: Vec::new(),
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
        let context = if at < 3 { Context::True } else { self.context() };
        let steps = self.rng.random_range(0..5);
        let body = self.steps(of, steps, 2);
        Plan {
            label: format!("p{at}"),
            atomic: self.rng.random_ratio(1, 12),
            trigger: Trigger {
                name: Span::default(),
                origin: Span::default(),
                on,
                args: vec![Term::Var(0)],
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

    /// A term that may bind a variable, which is bound from then on if that is wanted.
    fn term(&mut self, binds: bool) -> Term {
        match self.rng.random_range(0..3) {
            0 => Term::Any,
            1 => Term::Expr(self.expr()),
            _ => {
                let var = self.rng.random_range(0..VARS);
                if binds && !self.bound.contains(&var) {
                    self.bound.push(var);
                }
                Term::Var(var)
            }
        }
    }

    fn literal(&mut self, binds: bool) -> Literal {
        let annotations =
            if self.rng.random_ratio(1, 5) { vec![(Annotation::Source, Term::Any)] } else { Vec::new() };
        Literal { origin: Span::default(), belief: self.belief(), args: vec![self.term(binds)], annotations }
    }

    fn context(&mut self) -> Context {
        match self.rng.random_range(0..6) {
            0 => Context::True,
            1 => Context::Not(Box::new(Context::Belief(self.literal(false)))),
            2 => Context::Test(Expr::binary(BinaryOp::Lt, self.expr(), self.expr())),
            3 => Context::And(vec![Context::Belief(self.literal(true)), self.context()]),
            4 => {
                let formula = Context::Belief(self.literal(false));
                let count = Internal::Count { formula, out: self.term(true) };
                Context::Internal(Box::new(count), Span::default())
            }
            _ => Context::Belief(self.literal(true)),
        }
    }

    fn steps(&mut self, of: u16, count: usize, depth: u32) -> Vec<Step> {
        (0..count).map(|_| Step { kind: self.step(of, depth), origin: Span::default() }).collect()
    }

    /// A block's steps bind nothing for those behind it.
    fn block(&mut self, of: u16, depth: u32) -> Vec<Step> {
        let before = self.bound.clone();
        let count = self.rng.random_range(0..3);
        let steps = self.steps(of, count, depth - 1);
        self.bound = before;
        steps
    }

    fn step(&mut self, of: u16, depth: u32) -> StepKind {
        let belief = self.belief();
        let goal = GoalId(self.rng.random_range(0..GOALS));
        let seconds = Expr::float(f64::from(self.rng.random_range(0..8)) / 2.0);
        match self.rng.random_range(0..if depth > 0 { 22 } else { 18 }) {
            0 => StepKind::Do {
                event: self.event(Some(of)),
                args: vec![Expr::int(self.rng.random_range(-3..4))],
            },
            1 | 2 => {
                let within = self.rng.random_bool(0.3).then(|| seconds.clone());
                StepKind::Achieve { goal, args: vec![self.expr()], within }
            }
            3 => StepKind::Spawn { goal, args: vec![self.expr()] },
            4 => StepKind::Query(self.literal(true)),
            5 => StepKind::Test(self.context()),
            6 => StepKind::Add(Assertion { belief, args: vec![self.expr()], annotations: Vec::new() }),
            7 => StepKind::Remove(self.literal(false)),
            8 => StepKind::Replace(Assertion { belief, args: vec![self.expr()], annotations: Vec::new() }),
            9 => StepKind::Abolish(self.literal(false)),
            10 | 11 => {
                let pattern = EventPattern { event: self.event(None), args: vec![ArgPattern::Any] };
                let within = self.rng.random_bool(0.7).then_some(seconds);
                StepKind::Await { events: vec![pattern], within }
            }
            12 | 13 => StepKind::Wait { seconds },
            14 | 15 => self.message(),
            16 => self.question(seconds),
            17 => self.control(goal),
            18 => {
                let before = self.bound.clone();
                let condition = self.context();
                let then = self.block(of, depth);
                self.bound = before;
                StepKind::If { condition, then, otherwise: self.block(of, depth) }
            }
            19 => {
                let before = self.bound.clone();
                let condition = self.context();
                let body = self.block(of, depth);
                self.bound = before;
                StepKind::For { condition, body }
            }
            _ => {
                let all = self.rng.random_bool(0.5);
                StepKind::Fork { branches: vec![self.block(of, depth), self.block(of, depth)], all }
            }
        }
    }

    fn other(&mut self) -> Expr {
        let other = self.rng.random_range(0..self.agents);
        Expr::Const(Value::Symbol(Symbol::intern(&format!("agent{other}"))))
    }

    fn message(&mut self) -> StepKind {
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
        let args = vec![Term::Expr(self.expr())];
        StepKind::Send { to, performative, content: ContentId(content), args }
    }

    fn question(&mut self, seconds: Expr) -> StepKind {
        let (to, content) = (self.other(), ContentId(self.belief().0));
        let var = self.rng.random_range(0..VARS);
        if !self.bound.contains(&var) {
            self.bound.push(var);
        }
        StepKind::Ask { to, content, args: vec![Term::Var(var)], within: Some(seconds) }
    }

    fn control(&mut self, goal: GoalId) -> StepKind {
        let all = [
            Control::DropIntention,
            Control::DropDesire,
            Control::SucceedGoal,
            Control::FailGoal,
            Control::Suspend,
            Control::Resume,
            Control::Resume,
        ];
        let what = *all.choose(&mut self.rng).unwrap_or(&Control::Resume);
        StepKind::Control { what, goal: Some((goal, vec![Term::Any])) }
    }
}
