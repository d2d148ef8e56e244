//! The grammar page is generated from the grammar that the parser is made of: rules without their actions, bindings and
//! marks, left recursion as repetition, by the sections of the file.

use std::fmt::Write;

use crate::tables::generated;

/// A piece of the grammar's text.
#[derive(Clone, Debug, PartialEq)]
enum Token {
    /// `// ── Title ── text`
    Section(String),
    Comment(String),
    /// With its quotes.
    Literal(String),
    Name(String),
    /// A name with `<` right after it, which is no token of its own then: its arguments follow.
    Macro(String),
    Mark(char),
    /// `=>` and the code after it.
    Action,
}

fn tokens(text: &str) -> Vec<Token> {
    let chars: Vec<char> = text.chars().collect();
    let (mut at, mut out) = (0, Vec::new());
    while at < chars.len() {
        let rest = &chars[at..];
        let run = |ok: &dyn Fn(char) -> bool| rest.iter().take_while(|c| ok(**c)).collect::<String>();
        match rest {
            ['/', '/', ..] => {
                let line = run(&|c| c != '\n');
                at += line.chars().count();
                let said = line.trim_start_matches('/').trim();
                out.push(match said.strip_prefix("── ") {
                    Some(title) => Token::Section(title.to_owned()),
                    None => Token::Comment(said.to_owned()),
                });
            }
            ['"', ..] => {
                let inner: String = rest[1..].iter().take_while(|c| **c != '"').collect();
                at += inner.chars().count() + 2;
                out.push(Token::Literal(format!("\"{inner}\"")));
            }
            ['=', '>', ..] => {
                at += action(rest);
                out.push(Token::Action);
            }
            [c, ..] if c.is_alphanumeric() || *c == '_' => {
                let word = run(&|c| c.is_alphanumeric() || c == '_');
                at += word.chars().count();
                let is_macro = chars.get(at) == Some(&'<');
                at += usize::from(is_macro);
                out.push(if is_macro { Token::Macro(word) } else { Token::Name(word) });
            }
            [c, ..] => {
                at += 1;
                if !c.is_whitespace() {
                    out.push(Token::Mark(*c));
                }
            }
            [] => break,
        }
    }
    out
}

/// How long the code after `=>` is: to the comma, semicolon or bracket that ends the alternative.
fn action(text: &[char]) -> usize {
    let (mut depth, mut quoted) = (0usize, false);
    for (i, c) in text.iter().enumerate() {
        match c {
            '"' => quoted = !quoted,
            _ if quoted => {}
            '(' | '[' | '{' => depth += 1,
            ',' | ';' | '}' | ')' if depth == 0 => return i,
            ')' | ']' | '}' => depth -= 1,
            _ => {}
        }
    }
    text.len()
}

/// What may stand in a rule.
#[derive(Clone, Debug, PartialEq)]
enum Item {
    /// A word or mark with its quotes, or a token.
    Text(String),
    /// A rule with its arguments.
    Rule(String, Vec<Item>),
    Sequence(Vec<Item>),
    Choice(Vec<Item>),
    Optional(Box<Item>),
    Repeated(Box<Item>),
}

struct Rule {
    section: usize,
    comment: String,
    name: String,
    params: Vec<String>,
    body: Item,
}

struct Reader {
    tokens: Vec<Token>,
    at: usize,
}

impl Reader {
    fn peek(&self) -> Option<&Token> {
        self.tokens.get(self.at)
    }

    fn eat(&mut self, token: &Token) -> bool {
        let here = self.peek() == Some(token);
        self.at += usize::from(here);
        here
    }

    fn mark(&mut self, c: char) -> bool {
        self.eat(&Token::Mark(c))
    }

    fn name(&mut self) -> Option<String> {
        let Some(Token::Name(name)) = self.peek().cloned() else { return None };
        self.at += 1;
        Some(name)
    }

    /// `Name<Params>: Type = body`
    fn rule(&mut self, section: usize, comment: String) -> Rule {
        self.eat(&Token::Name("pub".to_owned()));
        let mut params = Vec::new();
        let name = if let Some(Token::Macro(name)) = self.peek().cloned() {
            self.at += 1;
            while !self.mark('>') {
                params.extend(self.name());
                self.mark(',');
            }
            name
        } else {
            self.name().expect("a rule begins with its name")
        };
        while !self.mark('=') {
            self.at += 1;
        }
        let body = if self.mark('{') {
            let mut choices = Vec::new();
            while !self.mark('}') {
                choices.push(self.alternative());
                self.mark(',');
            }
            choice(choices)
        } else {
            self.alternative()
        };
        self.mark(';');
        Rule { section, comment, name, params, body }
    }

    fn alternative(&mut self) -> Item {
        let mut items = Vec::new();
        loop {
            match self.peek() {
                Some(Token::Action) => self.at += 1,
                Some(Token::Comment(_)) => self.at += 1,
                None | Some(Token::Mark(',' | ';' | '}' | ')')) => return sequence(items),
                Some(_) => items.extend(self.item()),
            }
        }
    }

    /// A symbol with what stands after it; nothing for the marks of places.
    fn item(&mut self) -> Option<Item> {
        let item = self.symbol();
        if self.mark('?') {
            return item.map(|i| Item::Optional(Box::new(i)));
        }
        if self.mark('*') {
            return item.map(|i| Item::Repeated(Box::new(i)));
        }
        item
    }

    fn symbol(&mut self) -> Option<Item> {
        let token = self.peek().cloned()?;
        self.at += 1;
        match token {
            Token::Literal(text) => Some(Item::Text(text)),
            Token::Name(name) => Some(Item::Rule(name, Vec::new())),
            Token::Macro(name) => {
                let mut args = Vec::new();
                while !self.mark('>') {
                    args.extend(self.item());
                    self.mark(',');
                }
                Some(Item::Rule(name, args))
            }
            Token::Mark('@') => {
                self.at += 1;
                None
            }
            Token::Mark('(') => {
                let inner = self.alternative();
                self.mark(')');
                Some(inner)
            }
            // `<name: symbol>`
            Token::Mark('<') => {
                if let [Token::Name(_), Token::Mark(':'), ..] = &self.tokens[self.at..] {
                    self.at += 2;
                }
                let item = self.item();
                assert!(self.mark('>'), "a binding has an end: {:?}", &self.tokens[self.at - 3..]);
                item
            }
            Token::Section(_) | Token::Comment(_) | Token::Mark(_) | Token::Action => {
                panic!("not expected in a rule: {token:?}")
            }
        }
    }
}

fn sequence(mut items: Vec<Item>) -> Item {
    if items.len() == 1 { items.remove(0) } else { Item::Sequence(items) }
}

fn choice(mut items: Vec<Item>) -> Item {
    // What stands for broken text is no part of the language.
    items.retain(|i| *i != Item::Rule("ERROR".to_owned(), Vec::new()));
    if items.len() == 1 { items.remove(0) } else { Item::Choice(items) }
}

/// The alternatives of a body, each as a sequence.
fn alternatives(body: &Item) -> Vec<Vec<Item>> {
    let one = |item: &Item| match item {
        Item::Sequence(items) => items.clone(),
        other => vec![other.clone()],
    };
    match body {
        Item::Choice(items) => items.iter().map(one).collect(),
        other => vec![one(other)],
    }
}

/// `A = b | A c` is `b { c }`; an alternative that may be empty makes the others optional.
fn without_left_recursion(rule: &mut Rule) {
    let is_self = |i: &Item| matches!(i, Item::Rule(name, _) if *name == rule.name);
    let (again, base): (Vec<_>, Vec<_>) =
        alternatives(&rule.body).into_iter().partition(|a| a.first().is_some_and(is_self));
    let optional = base.iter().any(Vec::is_empty);
    let base: Vec<Item> = base.into_iter().filter(|a| !a.is_empty()).map(sequence).collect();
    let mut items = Vec::new();
    if !base.is_empty() {
        let base = choice(base);
        items.push(if optional { Item::Optional(Box::new(base)) } else { base });
    }
    if !again.is_empty() {
        let tails = again.into_iter().map(|a| sequence(a[1..].to_vec())).collect();
        items.push(Item::Repeated(Box::new(choice(tails))));
    }
    rule.body = sequence(items);
}

/// How often rules name a rule.
fn uses(rules: &[Rule], name: &str) -> usize {
    fn count(item: &Item, name: &str) -> usize {
        match item {
            Item::Text(_) => 0,
            Item::Rule(n, args) => {
                usize::from(n == name) + args.iter().map(|a| count(a, name)).sum::<usize>()
            }
            Item::Sequence(items) | Item::Choice(items) => items.iter().map(|i| count(i, name)).sum(),
            Item::Optional(item) | Item::Repeated(item) => count(item, name),
        }
    }
    rules.iter().map(|r| count(&r.body, name)).sum()
}

/// A rule that is nothing but another one, which only it names, becomes that one.
fn merge(rules: &mut Vec<Rule>) {
    loop {
        let alias = rules.iter().enumerate().find_map(|(i, r)| match &r.body {
            Item::Rule(name, args) if args.is_empty() && uses(rules, name) == 1 => {
                let j = rules.iter().position(|t| t.name == *name && t.params.is_empty())?;
                Some((i, j))
            }
            Item::Text(_)
            | Item::Rule(..)
            | Item::Sequence(_)
            | Item::Choice(_)
            | Item::Optional(_)
            | Item::Repeated(_) => None,
        });
        let Some((i, j)) = alias else { return };
        rules[i].body = rules[j].body.clone();
        rules.remove(j);
    }
}

fn read_rules(text: &str) -> (Vec<String>, Vec<Rule>) {
    let head = text.split_once("grammar<").and_then(|(_, text)| text.split_once(';'));
    let (_, text) = head.expect("the file's head");
    let text = text.split("// ── Tokens ──").next().unwrap_or_default();
    let mut reader = Reader { tokens: tokens(text), at: 0 };
    let (mut sections, mut rules) = (vec!["Declarations".to_owned()], Vec::new());
    let mut comment = String::new();
    while let Some(token) = reader.peek().cloned() {
        match token {
            Token::Section(title) => {
                reader.at += 1;
                sections.push(title);
            }
            Token::Comment(text) => {
                reader.at += 1;
                comment = format!("{comment} {text}").trim().to_owned();
            }
            Token::Literal(_) | Token::Name(_) | Token::Macro(_) | Token::Mark(_) | Token::Action => {
                let rule = reader.rule(sections.len() - 1, std::mem::take(&mut comment));
                rules.push(rule);
            }
        }
    }
    rules.retain(|r| r.name != "Unit");
    rules.iter_mut().for_each(without_left_recursion);
    merge(&mut rules);
    (sections, rules)
}

/// How an item is written; in `tight` places a choice is in parentheses.
fn shown(item: &Item, tight: bool) -> String {
    let all =
        |items: &[Item], by: &str, tight| items.iter().map(|i| shown(i, tight)).collect::<Vec<_>>().join(by);
    match item {
        Item::Text(text) => text.clone(),
        Item::Rule(name, args) if args.is_empty() => name.clone(),
        Item::Rule(name, args) => format!("{name}({})", all(args, ", ", true)),
        Item::Sequence(items) => all(items, " ", true),
        Item::Choice(items) if tight => format!("( {} )", all(items, " | ", false)),
        Item::Choice(items) => all(items, " | ", false),
        Item::Optional(item) => format!("[ {} ]", shown(item, false)),
        Item::Repeated(item) => format!("{{ {} }}", shown(item, false)),
    }
}

const WIDTH: usize = 120;

fn rule_text(rule: &Rule) -> String {
    let params = if rule.params.is_empty() { String::new() } else { format!("({})", rule.params.join(", ")) };
    let head = format!("{}{params} =", rule.name);
    let one = format!("{head} {}", shown(&rule.body, false));
    if one.chars().count() <= WIDTH {
        return one;
    }
    let Item::Choice(items) = &rule.body else { return wrapped(&one) };
    // Words fill lines, other alternatives have a line each.
    if items.iter().all(|i| matches!(i, Item::Text(_) | Item::Rule(..))) {
        return wrapped(&one);
    }
    let lines = items.iter().map(|i| wrapped(&format!("  | {}", shown(i, false))));
    let lines: Vec<String> = lines.collect();
    format!("{head}\n{}", lines.join("\n").replacen("  | ", "    ", 1))
}

/// A long line, broken at blanks.
fn wrapped(line: &str) -> String {
    let (mut out, mut width) = (String::new(), 0);
    for (i, word) in line.split(' ').enumerate() {
        if i > 0 && width + 1 + word.chars().count() > WIDTH {
            out.push_str("\n     ");
            width = 5;
        }
        if i > 0 {
            out.push(' ');
        }
        out.push_str(word);
        width += 1 + word.chars().count();
    }
    out
}

fn page(text: &str) -> String {
    let (sections, rules) = read_rules(text);
    let mut out = String::new();
    for (number, section) in sections.iter().enumerate() {
        let (title, note) = section.split_once(" ──").unwrap_or((section, ""));
        let _ = write!(out, "\n### {title}\n\n");
        if !note.trim().is_empty() {
            let note = note.trim();
            let (first, rest) = note.split_at(note.chars().next().map_or(0, char::len_utf8));
            let _ = write!(out, "{}{rest}\n\n", first.to_uppercase());
        }
        out.push_str("```ebnf\n");
        for rule in rules.iter().filter(|r| r.section == number) {
            if !rule.comment.is_empty() {
                let _ = writeln!(out, "(* {} *)", rule.comment);
            }
            let _ = writeln!(out, "{}", rule_text(rule));
        }
        out.push_str("```\n");
    }
    out
}

#[test]
fn the_grammar() {
    generated("spec/grammar.md", "rules", &page(hrdsl_compiler::GRAMMAR));
}

#[test]
fn rules_lose_their_actions_and_recursion() {
    let grammar = "grammar<'t, 'c>(cx: &'c mut Context<'t>);
        pub Unit: Box<Unit> = { <Item> END => x };
        Item: Box<(A, B)> = { \"use\" <path:Path> => Box::new(vec![1, 2]), <Allow>, ERROR => z };
        // ── Lists ── one, or more.
        // Separated.
        List<T, S>: Vec<Out<T>> = {
            <first:T> => vec![first.out()],
            <list:List<T, S>> S <next:T> => { let mut list = list; list.push(next); list },
        };
        Path: P = <l:@L> <kind:PathKind> <r:@R> => f(l, r);
        PathKind: K = <names:List<Name, \".\">> <with:(\"with\" <Name>)?> \";\"* => g(<>);
        Parts<T>: Vec<T> = { => Vec::new(), <list:Parts<T>> <next:T> => list };
        // ── Tokens ──";
    let text = page(grammar);
    let expected = "\n### Declarations\n\n```ebnf\nItem = \"use\" Path | Allow\n```\n\n### Lists\n\nOne, or more.\n\n\
        ```ebnf\n(* Separated. *)\nList(T, S) = T { S T }\n\
        Path = List(Name, \".\") [ \"with\" Name ] { \";\" }\nParts(T) = { T }\n```\n";
    assert_eq!(text, expected);
}
