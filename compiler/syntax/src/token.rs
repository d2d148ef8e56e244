//! The tokens of the language and the registry of its keywords.

use logos::Logos;

/// What a keyword reserves.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum KeywordClass {
    /// Starts a declaration; a name where none can start.
    Head,
    /// Holds the text together, and a name where it cannot be meant. Where a declaration is broken it is taken for the keyword.
    Hard,
    /// A keyword in its own place, a name everywhere else.
    Soft,
    /// Never a name.
    Reserved,
}

/// One row of the registry.
#[derive(Clone, Copy, Debug)]
pub struct Keyword {
    pub word: &'static str,
    pub class: KeywordClass,
    /// The construct that it belongs to, as the specification's table shows it.
    pub place: &'static str,
    pub(crate) kind: TokenKind,
}

macro_rules! tokens {
    ($($kind:ident $word:tt $class:ident $place:literal),* $(,)?) => {
        /// The kind of a token.
        #[derive(Logos, Clone, Copy, Debug, PartialEq, Eq)]
        #[logos(skip r"[ \t\r]+")]
        pub(crate) enum TokenKind {
            $(#[token($word)] $kind,)*

            #[token("_", priority = 9)] Any,
            #[regex("[A-Za-z_][A-Za-z0-9_]*", priority = 2)] Ident,
            #[regex("[0-9]+")] Int,
            #[regex(r"[0-9]+\.[0-9]+([eE][+-]?[0-9]+)?")] Float,
            #[regex(r#""([^"\\\n]|\\[^\n])*""#)] Str,

            #[token("(")] LParen,
            #[token(")")] RParen,
            #[token("{")] LBrace,
            #[token("}")] RBrace,
            #[token("[")] LBracket,
            #[token("]")] RBracket,
            #[token("^")] Caret,
            #[token(",")] Comma,
            #[token(";")] Semi,
            #[token(":")] Colon,
            #[token(".")] Dot,
            #[token("..")] DotDot,
            #[token("@")] At_,
            #[token("?")] Question,
            #[token("|")] Pipe,
            #[token("->")] Arrow,
            #[token("-->")] LongArrow,
            #[token("E<>")] Possibly,
            #[token("A[]")] Invariantly,
            #[token("E[]")] PotentiallyAlways,
            #[token("A<>")] Eventually,
            #[token("=")] Assign,
            #[token("+=")] PlusAssign,
            #[token("-=")] MinusAssign,
            #[token("-+")] MinusPlus,
            #[token("!")] Bang,
            #[token("!!")] BangBang,
            #[token("&&")] AndAnd,
            #[token("||")] OrOr,
            #[token("==")] Eq,
            #[token("!=")] Ne,
            #[token("<")] Lt,
            #[token("<=")] Le,
            #[token(">")] Gt,
            #[token(">=")] Ge,
            #[token("+")] Plus,
            #[token("-")] Minus,
            #[token("*")] Star,
            #[token("/")] Slash,
            #[token("%")] Percent,
            #[token("~")] Tilde,

            // Seen by the lexer only.
            #[token("\n")] Newline,
            #[regex(r"//[^\n]*", allow_greedy = true)] Comment,
            #[regex(r#""([^"\\\n]|\\[^\n])*\\?"#)] OpenStr,

            // Made by the lexer.
            /// A number and its unit.
            Quantity,
            /// A name before `->`.
            From,
            /// The dot before the name of an internal action.
            Internal,
            /// Text that could not be read; the diagnostic has been made.
            Error,

            // Made by the driver: what is to be read, and its end.
            StartStimulusStep,
            StartAgentMember,
            StartStep,
            StartStatement,
            StartAutomatonMember,
            StartCrossMember,
            StartSuiteMember,
            StartTestMember,
            StartWorldMember,
            StartDeviceMember,
            StartSystemMember,
            End,
        }

        /// All keywords, by where they belong.
        pub const KEYWORDS: &[Keyword] = &[
            $(Keyword { word: $word, class: KeywordClass::$class, place: $place, kind: TokenKind::$kind }),*
        ];

        impl TokenKind {
            /// What a keyword reserves; `None` for every other token.
            pub(crate) fn class(self) -> Option<KeywordClass> {
                match self {
                    $(Self::$kind => Some(KeywordClass::$class),)*
                    _ => None,
                }
            }
        }
    };
}

tokens! {
    Scenario "scenario" Head "the first line of a scenario",
    Use "use" Head "declaration",
    Actor "actor" Head "declaration",
    Const "const" Head "declaration",
    Event "event" Head "declaration",
    Stimulus "stimulus" Head "declaration",
    Agent "agent" Head "declaration",
    Var "var" Head "declaration, automaton, function",
    Channel "channel" Head "declaration",
    Fn "fn" Head "declaration, automaton",
    Automaton "automaton" Head "declaration",
    Network "network" Head "declaration",
    Query "query" Head "declaration, suite",
    Require "require" Head "declaration",
    Assume "assume" Head "declaration",
    Cover "cover" Head "declaration",
    Cross "cross" Head "declaration",
    Suite "suite" Head "declaration",
    Part "part" Head "declaration, world",
    Device "device" Head "declaration",
    World "world" Head "declaration",
    System "system" Head "declaration, actor",
    Test "test" Head "declaration",
    Enum "enum" Head "declaration",
    Record "record" Head "declaration",
    Allow "allow" Head "before what is allowed",

    True "true" Reserved "expression",
    False "false" Reserved "expression",
    Not "not" Reserved "expression",
    And "and" Reserved "expression, plan",
    Or "or" Reserved "expression, list of events, plan",
    Imply "imply" Hard "expression",
    If "if" Hard "expression, stimulus, plan, function",
    Else "else" Hard "expression, stimulus, plan, function, device",
    Return "return" Hard "function",
    FromWord "from" Hard "event",
    To "to" Hard "event, signal",
    By "by" Hard "stimulus, suite, world",
    In "in" Hard "stimulus, world, function",
    Plays "plays" Hard "agent, automaton",
    When "when" Hard "plan, edge, cross, world",
    On "on" Hard "belief, plan, edge, world",
    Do "do" Hard "edge, device",
    Emit "emit" Hard "stimulus, world",
    Within "within" Hard "plan, requirement, test",
    Await "await" Hard "plan, suite, test",

    Sample "sample" Soft "stimulus, world",
    Hold "hold" Soft "stimulus",
    Belief "belief" Soft "agent",
    Goal "goal" Soft "agent",
    Plan "plan" Soft "agent, suite",
    Rule "rule" Soft "agent",
    For "for" Soft "plan, function",
    Fork "fork" Soft "plan",
    Wait "wait" Soft "plan, test",
    Clock "clock" Soft "automaton",
    Init "init" Soft "automaton",
    Committed "committed" Soft "automaton",
    Urgent "urgent" Soft "automaton, channel",
    Location "location" Soft "automaton, suite",
    Broadcast "broadcast" Soft "channel",
    Sup "sup" Soft "query",
    Inf "inf" Soft "query",
    Invariant "invariant" Soft "automaton",
    Select "select" Soft "edge",
    After "after" Soft "requirement, suite",
    Causes "causes" Soft "requirement",
    Forbids "forbids" Soft "requirement",
    Until "until" Soft "requirement",
    Never "never" Soft "requirement",
    While "while" Soft "requirement, plan, function",
    Globally "globally" Soft "requirement",
    At "at" Soft "assumption, world",
    Most "most" Soft "assumption",
    Count "count" Soft "coverage",
    Bins "bins" Soft "coverage",
    Bin "bin" Soft "cross, suite",
    Ignore "ignore" Soft "cross",
    Agents "agents" Soft "suite",
    Search "search" Soft "suite",
    Random "random" Soft "suite",
    Of "of" Soft "suite, query",
    Choose "choose" Soft "suite",
    One "one" Soft "suite",
    AnyWord "any" Soft "suite",
    Per "per" Soft "suite",
    Where "where" Soft "suite",
    Explore "explore" Soft "suite",
    Stop "stop" Soft "suite",
    Minimise "minimise" Soft "suite",
    Witness "witness" Soft "suite",
    Delays "delays" Soft "suite",
    Tests "tests" Soft "suite",
    Horizon "horizon" Soft "suite",
    Patience "patience" Soft "suite",
    Reach "reach" Soft "suite, world",
    Each "each" Soft "suite",
    Edge "edge" Soft "suite",
    Stimuli "stimuli" Soft "suite",
    Length "length" Soft "suite",
    Pause "pause" Soft "suite",
    Seed "seed" Soft "test",
    Method "method" Soft "test",
    Because "because" Soft "test",
    Predicts "predicts" Soft "test",
    With "with" Soft "test",
    Step "step" Soft "world",
    Gravity "gravity" Soft "world",
    Body "body" Soft "world",
    Joint "joint" Soft "world, channel",
    Arm "arm" Soft "world",
    Gripper "gripper" Soft "world",
    Current "current" Soft "world",
    Signal "signal" Soft "world",
    Rotated "rotated" Soft "world",
    Mass "mass" Soft "world",
    Ghost "ghost" Soft "world",
    Graspable "graspable" Soft "world",
    Axis "axis" Soft "world",
    Limits "limits" Soft "world",
    Tip "tip" Soft "world",
    Tool "tool" Soft "world",
    Speed "speed" Soft "world",
    Delay "delay" Soft "world",
    Command "command" Soft "device",
    Expect "expect" Soft "device",
    Run "run" Soft "system",
    Coverage "coverage" Soft "system",
    Limit "limit" Soft "system",
    Budget "budget" Soft "system",
    Cpu "cpu" Soft "system",
    Wall "wall" Soft "system",
    Memory "memory" Soft "system",
    Output "output" Soft "system",
    Env "env" Soft "system",
    Online "online" Soft "system",
}

impl TokenKind {
    /// Starts a declaration.
    pub(crate) fn is_head(self) -> bool {
        self.class() == Some(KeywordClass::Head)
    }

    /// Starts a declaration that ends with its closing brace.
    pub(crate) fn has_block(self) -> bool {
        matches!(
            self,
            Self::Stimulus
                | Self::Agent
                | Self::Automaton
                | Self::Fn
                | Self::Cross
                | Self::Suite
                | Self::Part
                | Self::Device
                | Self::World
                | Self::System
                | Self::Test
                | Self::Enum
                | Self::Record
        )
    }

    /// Looks like a name: an identifier or a soft keyword.
    pub(crate) fn is_name(self) -> bool {
        self == Self::Ident || self.class() == Some(KeywordClass::Soft)
    }

    /// Can be a name somewhere: every word that is not reserved.
    pub(crate) fn can_be_name(self) -> bool {
        self.is_word() && self.class() != Some(KeywordClass::Reserved)
    }

    /// May be the first token of a step that names what is done. Words that hold the text together are hardly meant so.
    pub(crate) fn starts_call(self) -> bool {
        self.is_name() || self.is_head()
    }

    /// An identifier or any keyword.
    pub(crate) fn is_word(self) -> bool {
        self == Self::Ident || self.class().is_some()
    }

    /// May be the first token of an operand.
    pub(crate) fn starts_operand(self) -> bool {
        self.is_name()
            || matches!(
                self,
                Self::Int
                    | Self::Float
                    | Self::Quantity
                    | Self::LParen
                    | Self::Any
                    | Self::True
                    | Self::False
                    | Self::Str
                    | Self::LBracket
                    | Self::Tilde
                    | Self::Internal
                    | Self::Error
            )
    }

    /// May be the last token of an operand, or of a member.
    pub(crate) fn ends_operand(self) -> bool {
        self.is_name()
            || matches!(
                self,
                Self::Int
                    | Self::Float
                    | Self::Quantity
                    | Self::Str
                    | Self::RParen
                    | Self::RBracket
                    | Self::RBrace
                    | Self::Any
                    | Self::True
                    | Self::False
                    | Self::Error
            )
    }

    /// An operator of expressions; each adds a level to the tree.
    pub(crate) fn is_operator(self) -> bool {
        matches!(
            self,
            Self::Plus
                | Self::Minus
                | Self::Star
                | Self::Slash
                | Self::Percent
                | Self::Bang
                | Self::BangBang
                | Self::Not
                | Self::And
                | Self::Or
                | Self::Imply
                | Self::AndAnd
                | Self::OrOr
                | Self::Eq
                | Self::Ne
                | Self::Lt
                | Self::Le
                | Self::Gt
                | Self::Ge
                | Self::If
                | Self::Tilde
        )
    }

    /// What follows belongs to what is before, also on a new line.
    pub(crate) fn continues(self) -> bool {
        (self.is_operator() && !matches!(self, Self::Bang | Self::BangBang | Self::If | Self::Tilde))
            || matches!(
                self,
                Self::Comma
                    | Self::Colon
                    | Self::Dot
                    | Self::DotDot
                    | Self::LParen
                    | Self::LBracket
                    | Self::Pipe
                    | Self::Arrow
                    | Self::LongArrow
                    | Self::Assign
                    | Self::PlusAssign
                    | Self::MinusAssign
                    | Self::At_
            )
    }
}

/// One token where it was written.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Lexeme {
    pub kind: TokenKind,
    /// The first of its line.
    pub first: bool,
    pub start: u32,
    pub end: u32,
    /// Where the unit of a quantity starts.
    pub unit: u32,
}

impl Lexeme {
    /// A token without text, made by the driver.
    pub(crate) fn synthetic(kind: TokenKind, at: u32) -> Self {
        Self { kind, first: false, start: at, end: at, unit: at }
    }
}
