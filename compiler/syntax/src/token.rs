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

/// What else may be true of a keyword, where it stands as one.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum KeywordTrait {
    /// The grammar says place by place where it may be a name; all others may be one wherever `Soft` is.
    Apart,
    /// Starts a clause, before which a long line is broken.
    Clause,
    /// May follow an event in a requirement.
    AfterEvent,
    /// Stands between the trigger of a requirement and what is said of it.
    Response,
    /// In a requirement an event may follow, as the first of a part of its own.
    BeforeEvent,
    /// Starts a clause of a sensor.
    Sensing,
    /// At the level of declarations a name follows.
    WantsName,
    // Starts a member, or a step, of such a block.
    InStimulus,
    InAgent,
    InAutomaton,
    InCross,
    InSuite,
    InTest,
    InWorld,
    InDevice,
    InSystem,
    InBinding,
}

/// One row of the registry.
#[derive(Clone, Copy, Debug)]
pub struct Keyword {
    pub word: &'static str,
    pub class: KeywordClass,
    /// The construct that it belongs to, as the specification's table shows it.
    pub place: &'static str,
    pub(crate) kind: TokenKind,
    pub traits: &'static [KeywordTrait],
}

macro_rules! keywords {
    ($($kind:ident $word:tt $class:ident $place:literal [$($holds:ident)*];)*) => {
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
            StartBindingMember,
            StartBindingEntry,
            End,
        }

        /// All keywords, by where they belong.
        pub const KEYWORDS: &[Keyword] = &[
            $(Keyword {
                word: $word,
                class: KeywordClass::$class,
                place: $place,
                kind: TokenKind::$kind,
                traits: &[$(KeywordTrait::$holds),*],
            }),*
        ];

        impl TokenKind {
            /// What a keyword reserves; `None` for every other token.
            pub(crate) fn class(self) -> Option<KeywordClass> {
                match self {
                    $(Self::$kind => Some(KeywordClass::$class),)*
                    _ => None,
                }
            }

            /// Whether the registry says this of a keyword.
            pub(crate) fn is(self, what: KeywordTrait) -> bool {
                let traits: &[KeywordTrait] = match self {
                    $(Self::$kind => &[$(KeywordTrait::$holds),*],)*
                    _ => &[],
                };
                traits.contains(&what)
            }
        }
    };
}

include!("keywords.in");

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

    /// The name that an edge leaves from.
    pub(crate) fn starts_edge(self) -> bool {
        self == Self::From
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
