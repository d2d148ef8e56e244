use hrdsl_import::{Source, uppaal};
#[allow(clippy::disallowed_methods)]
fn main() {
    let a: Vec<String> = std::env::args().collect();
    let s = |n: &String| Source { name: n.clone(), text: std::fs::read_to_string(n).unwrap() };
    let q = a.get(2).map(s);
    match uppaal::import(&s(&a[1]), q.as_ref(), &uppaal::Options::default()) {
        Ok(i) => {
            println!("{}", i.text);
            for n in i.notes {
                eprintln!("{n}");
            }
        }
        Err(e) => {
            for e in e {
                eprintln!("{e}");
            }
        }
    }
}
