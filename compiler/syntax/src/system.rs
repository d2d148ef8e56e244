//! Systems under test as they are written: their programs, limits, and what is bound to a middleware.

use hrdsl_source::Span;
use serde::Serialize;

use crate::{
    binding::MiddlewareSyntax,
    expr::{ExprSyntax, NameSyntax, TextSyntax},
};

/// `system robot { run "python3 robot.py" … }`, `system with_rospy plays robot { … }`
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct SystemSyntax {
    /// Without one of its own it is called as its actor.
    pub own_name: Option<NameSyntax>,
    pub actor: NameSyntax,
    pub members: Vec<SystemMember>,
}

impl SystemSyntax {
    /// As it is chosen by.
    #[must_use]
    pub fn name(&self) -> &NameSyntax {
        self.own_name.as_ref().unwrap_or(&self.actor)
    }
}

#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct SystemMember {
    pub kind: SystemMemberKind,
    pub span: Span,
}

#[derive(Clone, Debug, PartialEq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum SystemMemberKind {
    /// `run "python3 robot.py"`
    Run(TextSyntax),
    /// `coverage "robot.py", "fsm.py"`
    Coverage(Vec<TextSyntax>),
    /// `limit 300 s`: simulated time
    Limit(ExprSyntax),
    /// `budget 10 s`: processor time, or sleep, for one request
    Budget(ExprSyntax),
    /// `cpu 5 min`: processor time for a test
    Cpu(ExprSyntax),
    /// `wall 1 h`: wall time for a test
    Wall(ExprSyntax),
    /// `memory 2 GB`: for each process
    Memory(ExprSyntax),
    /// `output 10 MB`: for a test
    Output(ExprSyntax),
    /// `env ROBOT_NAME, ROS_DOMAIN_ID`: variables of the environment that are handed on
    Env(Vec<NameSyntax>),
    /// `online`: it uses the machine's network
    Online,
    /// `program brain { run "python3 robot.py" }`
    Program(ProgramSyntax),
    /// `ros1 { topic "/scan" : … }`
    Middleware(MiddlewareSyntax),
    Error,
}

/// One of several programs of a system.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct ProgramSyntax {
    pub name: NameSyntax,
    pub members: Vec<SystemMember>,
}
