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

/// What else may be true of a token: of a keyword, where it stands as one.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum TokenTrait {
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
    /// Starts a declaration that ends with its closing brace.
    Block,
    /// Members that start so are aligned at their `=`.
    AlignedAtAssign,
    /// Where nothing but parentheses follows it, it is a name.
    WantsRest,
    /// Starts a step of a test, of which it is not the only word.
    TestStep,
    /// May be the first token of an operand.
    StartsOperand,
    /// May be the last token of an operand, or of a member.
    EndsOperand,
    /// An operator of expressions; each adds a level to the tree.
    Operator,
    Comparison,
    /// What follows belongs to what is before, also on a new line.
    Continues,
    /// Ends a name within something else, or goes on with it, and starts nothing.
    EndsName,
    /// Stands after a name that is declared or set.
    AfterDeclared,
    /// Shows that the word before it is a name, and not the unit of a number.
    AfterName,
    /// Starts a step of a plan.
    StartsStep,
    /// Starts a step of a plan and, at the start of a line, is nothing else.
    StartsOnlyStep,
    /// No blank follows it.
    NoBlankAfter,
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

impl TokenTrait {
    const fn bit(self) -> u64 {
        1 << self as u32
    }
}

/// One row of the registry.
#[derive(Clone, Copy, Debug)]
pub struct Keyword {
    pub word: &'static str,
    pub class: KeywordClass,
    /// The construct that it belongs to, as the specification's table shows it.
    pub place: &'static str,
    pub(crate) kind: TokenKind,
    pub traits: &'static [TokenTrait],
}

/// Makes the kinds of tokens and what is true of them: of keywords, of signs, and of all others.
macro_rules! tokens {
    (
        { $($kind:ident $word:tt $class:ident $place:literal [$($holds:ident)*];)* }
        { $($sign:tt $sign_kind:ident [$($sign_holds:ident)*];)* }
        { $($(#[$($attribute:tt)*])* $other:ident [$($other_holds:ident)*];)* }
    ) => {
        /// The kind of a token.
        #[derive(Logos, Clone, Copy, Debug, PartialEq, Eq)]
        #[logos(skip r"[ \t\r]+")]
        pub(crate) enum TokenKind {
            $(#[token($word)] $kind,)*
            $(#[token($sign)] $sign_kind,)*
            $($(#[$($attribute)*])* $other,)*
        }

        /// All keywords, by where they belong.
        pub const KEYWORDS: &[Keyword] = &[
            $(Keyword {
                word: $word,
                class: KeywordClass::$class,
                place: $place,
                kind: TokenKind::$kind,
                traits: &[$(TokenTrait::$holds),*],
            }),*
        ];

        impl TokenKind {
            /// What a keyword reserves; `None` for every other token.
            pub(crate) fn class(self) -> Option<KeywordClass> {
                match self {
                    $(Self::$kind => Some(KeywordClass::$class),)*
                    $(Self::$sign_kind => None,)*
                    $(Self::$other => None,)*
                }
            }

            /// Whether the registry says this of it.
            pub(crate) fn is(self, what: TokenTrait) -> bool {
                // A bit for each trait: this is asked several times of each token.
                let traits: u64 = match self {
                    $(Self::$kind => 0 $(| TokenTrait::$holds.bit())*,)*
                    $(Self::$sign_kind => 0 $(| TokenTrait::$sign_holds.bit())*,)*
                    $(Self::$other => 0 $(| TokenTrait::$other_holds.bit())*,)*
                };
                traits & what.bit() != 0
            }
        }
    };
}

/// Adds to the keywords what is no word of its own: signs; names, numbers and texts; what the lexer and the driver make.
macro_rules! keywords {
    ($($keyword:tt)*) => {
        tokens! {
            { $($keyword)* }
            {
                "(" LParen [StartsOperand Continues AfterDeclared AfterName NoBlankAfter];
                ")" RParen [EndsOperand EndsName AfterDeclared];
                "{" LBrace [];
                "}" RBrace [EndsOperand];
                "[" LBracket [StartsOperand Continues NoBlankAfter];
                "]" RBracket [EndsOperand EndsName];
                "^" Caret [];
                "," Comma [Continues EndsName AfterDeclared];
                ";" Semi [AfterDeclared];
                ":" Colon [Continues EndsName AfterDeclared AfterName];
                "." Dot [Continues AfterName NoBlankAfter];
                ".." DotDot [Continues EndsName];
                "@" At_ [Continues NoBlankAfter];
                "?" Question [StartsStep StartsOnlyStep];
                "|" Pipe [Continues EndsName];
                "->" Arrow [Continues AfterDeclared AfterName];
                "-->" LongArrow [Continues];
                "E<>" Possibly [];
                "A[]" Invariantly [];
                "E[]" PotentiallyAlways [];
                "A<>" Eventually [];
                "=" Assign [Continues EndsName AfterDeclared AfterName];
                "+=" PlusAssign [Continues EndsName AfterName];
                "-=" MinusAssign [Continues EndsName AfterName];
                "-+" MinusPlus [StartsStep StartsOnlyStep NoBlankAfter];
                "!" Bang [Operator StartsStep StartsOnlyStep];
                "!!" BangBang [Operator StartsStep StartsOnlyStep];
                "&&" AndAnd [Operator Continues EndsName];
                "||" OrOr [Operator Continues EndsName];
                "==" Eq [Operator Comparison Continues EndsName];
                "!=" Ne [Operator Comparison Continues EndsName];
                "<" Lt [Operator Comparison Continues EndsName];
                "<=" Le [Operator Comparison Continues EndsName];
                ">" Gt [Operator Comparison Continues EndsName];
                ">=" Ge [Operator Comparison Continues EndsName];
                "+" Plus [Operator Continues EndsName StartsStep];
                "-" Minus [Operator Continues StartsStep];
                "*" Star [Operator Continues EndsName];
                "/" Slash [Operator Continues EndsName];
                "%" Percent [Operator Continues EndsName];
                "~" Tilde [StartsOperand Operator NoBlankAfter];
            }
            {
                #[token("_", priority = 9)] Any [StartsOperand EndsOperand];
                #[regex("[A-Za-z_][A-Za-z0-9_]*", priority = 2)] Ident [];
                #[regex("[0-9]+")] Int [StartsOperand EndsOperand];
                #[regex(r"[0-9]+\.[0-9]+([eE][+-]?[0-9]+)?")] Float [StartsOperand EndsOperand];
                #[regex(r#""([^"\\\n]|\\[^\n])*""#)] Str [StartsOperand EndsOperand];

                // Seen by the lexer only.
                #[token("\n")] Newline [];
                #[regex(r"//[^\n]*", allow_greedy = true)] Comment [];
                #[regex(r#""([^"\\\n]|\\[^\n])*\\?"#)] OpenStr [];

                // Made by the lexer.
                /// A number and its unit.
                Quantity [StartsOperand EndsOperand];
                /// A name before `->`.
                From [];
                /// The dot before the name of an internal action.
                Internal [StartsOperand StartsStep StartsOnlyStep NoBlankAfter];
                /// Text that could not be read; the diagnostic has been made.
                Error [StartsOperand EndsOperand];

                // Made by the driver: what is to be read, and its end.
                StartStimulusStep [];
                StartAgentMember [];
                StartStep [];
                StartStatement [];
                StartAutomatonMember [];
                StartCrossMember [];
                StartSuiteMember [];
                StartTestMember [];
                StartWorldMember [];
                StartDeviceMember [];
                StartSystemMember [];
                StartBindingMember [];
                StartBindingEntry [];
                End [];
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
        self.is(TokenTrait::Block)
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
        self.is_name() || self.is(TokenTrait::StartsOperand)
    }

    /// May be the last token of an operand, or of a member.
    pub(crate) fn ends_operand(self) -> bool {
        self.is_name() || self.is(TokenTrait::EndsOperand)
    }

    /// An operator of expressions; each adds a level to the tree.
    pub(crate) fn is_operator(self) -> bool {
        self.is(TokenTrait::Operator)
    }

    /// What follows belongs to what is before, also on a new line.
    pub(crate) fn continues(self) -> bool {
        self.is(TokenTrait::Continues)
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
