//! Models of UPPAAL that are imported and asked: whole ones, and small ones of a single template.

use std::{fmt::Write, fs, path::Path};

use super::{expect_code, hrdsl_in, stderr, stdout};

/// What is answered to each query of a model: a verdict, or a bound.
pub fn answers(folder: &Path, model: &str) -> Vec<String> {
    let out = hrdsl_in(folder, &format!("import uppaal {model} -o there.hri"));
    assert_eq!(out.status.code(), Some(0), "{}", stderr(&out));
    let out = hrdsl_in(folder, "check there.hri");
    let text = || fs::read_to_string(folder.join("there.hri")).unwrap();
    assert_eq!(out.status.code(), Some(0), "{}{}\n{}", stdout(&out), stderr(&out), text());
    let out = hrdsl_in(folder, "prove there.hri --json");
    let document: serde_json::Value = serde_json::from_str(&stdout(&out))
        .unwrap_or_else(|e| panic!("{e}: {}{}\n{}", stdout(&out), stderr(&out), text()));
    let queries = document["networks"][0]["queries"].as_array().unwrap();
    let answer = |q: &serde_json::Value| match q["bounds"].as_array() {
        Some(bounds) => bounds.iter().filter_map(|b| b.as_str()).collect::<Vec<_>>().join(", "),
        None => q["verdict"].as_str().unwrap_or_default().to_owned(),
    };
    queries.iter().map(answer).collect()
}

pub const YES: &str = "satisfied";
pub const NO: &str = "not_satisfied";

pub type Label = (&'static str, &'static str);

/// A model of one template `P` with the locations `a` and `b`, and what is asked of it.
pub struct SmallModel {
    pub global: &'static str,
    pub parameters: &'static str,
    pub local: &'static str,
    /// Labels of the location `a`.
    pub at_a: &'static [Label],
    /// Transitions: from, to, labels.
    pub edges: &'static [(&'static str, &'static str, &'static [Label])],
    pub system: &'static str,
}

pub const SMALL: SmallModel =
    SmallModel { global: "", parameters: "", local: "", at_a: &[], edges: &[], system: "system P;" };

fn escaped(text: &str) -> String {
    text.replace('&', "&amp;").replace('<', "&lt;").replace('>', "&gt;")
}

impl SmallModel {
    pub fn xml(&self, queries: &[&str]) -> String {
        let labels = |of: &[(&str, &str)]| -> String {
            of.iter().fold(String::new(), |mut all, (kind, text)| {
                let _ = write!(all, "<label kind=\"{kind}\">{}</label>", escaped(text));
                all
            })
        };
        let mut edges = String::new();
        for (from, to, of) in self.edges {
            let ends = format!("<source ref=\"{from}\"/><target ref=\"{to}\"/>");
            let _ = writeln!(edges, "<transition>{ends}{}</transition>", labels(of));
        }
        let asked: String =
            queries.iter().map(|q| format!("<query><formula>{}</formula></query>\n", escaped(q))).collect();
        format!(
            "<nta><declaration>{}</declaration>\n<template><name>P</name><parameter>{}</parameter>\n\
             <declaration>{}</declaration>\n<location id=\"a\"><name>a</name>{}</location>\n\
             <location id=\"b\"><name>b</name></location><init ref=\"a\"/>\n{edges}</template>\n\
             <system>{}</system>\n<queries>{asked}</queries></nta>",
            escaped(self.global),
            escaped(self.parameters),
            escaped(self.local),
            labels(self.at_a),
            escaped(self.system),
        )
    }

    /// Each query has the answer beside it.
    pub fn answers(&self, asked: &[(&str, &str)]) {
        let folder = tempfile::tempdir().unwrap();
        let queries: Vec<&str> = asked.iter().map(|(query, _)| *query).collect();
        fs::write(folder.path().join("small.xml"), self.xml(&queries)).unwrap();
        let given = answers(folder.path(), "small.xml");
        for ((query, expected), given) in asked.iter().zip(&given) {
            let text = fs::read_to_string(folder.path().join("there.hri")).unwrap();
            assert_eq!(given, expected, "{query}\n{text}");
        }
        assert_eq!(given.len(), asked.len());
    }

    /// What the import says besides.
    pub fn notes(&self) -> String {
        let folder = tempfile::tempdir().unwrap();
        fs::write(folder.path().join("small.xml"), self.xml(&[])).unwrap();
        let out = hrdsl_in(folder.path(), "import uppaal small.xml -o there.hri");
        expect_code(&out, 0);
        stderr(&out)
    }

    /// Why it is refused.
    pub fn refused(&self) -> String {
        let folder = tempfile::tempdir().unwrap();
        fs::write(folder.path().join("small.xml"), self.xml(&[])).unwrap();
        let out = hrdsl_in(folder.path(), "import uppaal small.xml -o there.hri");
        expect_code(&out, 1);
        stderr(&out)
    }
}
