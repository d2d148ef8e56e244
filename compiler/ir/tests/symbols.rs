//! Symbols and enumerations, alone and as values and types.

use proptest::prelude::*;

use hrdsl_ir::{Enumeration, Symbol};
use hrdsl_ir::{Type, Value};

#[test]
fn values_stay_small() {
    assert_eq!(size_of::<Value>(), 16);
    fn copies<T: Copy>() {}
    copies::<Value>();
    copies::<Type>();
}

#[test]
fn a_name_is_kept_once() {
    let (a, b) = (Symbol::intern("kept_once"), Symbol::intern("kept_once"));
    assert!(std::ptr::eq(a.name(), b.name()));
    assert_ne!(a, Symbol::intern("kept_twice"));
    assert_eq!((format!("{a}"), format!("{a:?}")), ("kept_once".into(), "kept_once".into()));
}

#[test]
fn an_enumeration_keeps_its_order() {
    let pace = Enumeration::intern("Pace", &["slow", "normal", "fast"]);
    let names: Vec<&str> = pace.values().iter().map(|v| v.name()).collect();
    assert_eq!((pace.name(), names), ("Pace", vec!["slow", "normal", "fast"]));
    assert_eq!(pace.index_of(Symbol::intern("fast")), Some(2));
    assert_eq!(pace.index_of(Symbol::intern("stopped")), None);
    assert_eq!(pace.symbol("normal"), Some(Symbol::intern("normal")));
    assert_eq!(pace.symbol("Normal"), None);
    assert_eq!(pace.listed(), "`slow`, `normal`, `fast`");
    assert_eq!(format!("{pace:?}"), "Pace {slow, normal, fast}");
    assert_ne!(pace, Enumeration::intern("Pace", &["slow", "fast"]));
    assert_ne!(pace, Enumeration::intern("Speed", &["slow", "normal", "fast"]));
    assert_eq!(Enumeration::intern("Twice", &["a", "b", "a"]).values().len(), 2);
}

#[test]
fn an_enumeration_is_written_with_its_values() {
    let ty = Type::Enum(Enumeration::intern("Hand", &["left", "right"]));
    let text = serde_json::to_string(&ty).unwrap();
    assert_eq!(text, r#"{"enum":{"name":"Hand","values":["left","right"]}}"#);
    assert_eq!(serde_json::from_str::<Type>(&text).unwrap(), ty);
}

/// The numbers are part of what makes a run reproducible: they must not change.
#[test]
fn keys_depend_on_the_name_only() {
    assert_eq!(Value::Symbol(Symbol::intern("")).key(), (3, 0xcbf2_9ce4_8422_2325));
    assert_eq!(Value::Symbol(Symbol::intern("a")).key(), (3, 0xaf63_dc4c_8601_ec8c));
}

proptest! {
    #![proptest_config(ProptestConfig { failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn a_symbol_is_its_name(a in "\\PC{0,12}", b in "[ab]{0,3}", c in "[ab]{0,3}") {
        prop_assert_eq!(Symbol::intern(&a).name(), a.as_str());
        let (x, y) = (Symbol::intern(&b), Symbol::intern(&c));
        prop_assert_eq!(x == y, b == c);
        prop_assert_eq!(x.cmp(&y), b.cmp(&c));
        prop_assert_eq!(Value::Symbol(x).key() == Value::Symbol(y).key(), b == c);
    }

    #[test]
    fn values_are_read_back(name in "\\PC{0,12}", b in any::<bool>(), n in any::<i64>(), x in -1e300f64..1e300) {
        for value in [Value::Symbol(Symbol::intern(&name)), Value::Bool(b), Value::Int(n), Value::Float(x)] {
            let text = serde_json::to_string(&value).unwrap();
            let read: Value = serde_json::from_str(&text).unwrap();
            prop_assert_eq!(read.key(), value.key(), "{}", text);
        }
    }

    #[test]
    fn enumerations_are_read_back(name in "[A-Z][a-z]{0,2}", values in prop::collection::vec("[a-d]{1,2}", 0..6)) {
        let values: Vec<&str> = values.iter().map(String::as_str).collect();
        let made = Enumeration::intern(&name, &values);
        let text = serde_json::to_string(&made).unwrap();
        prop_assert_eq!(serde_json::from_str::<Enumeration>(&text).unwrap(), made);
        for (i, value) in made.values().iter().enumerate() {
            prop_assert_eq!(made.index_of(*value), Some(i));
            prop_assert_eq!(made.symbol(value.name()), Some(*value));
            prop_assert!(Type::Enum(made).admits(Value::Symbol(*value)));
        }
    }
}
