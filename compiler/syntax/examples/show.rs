use hrdsl_source::*;
use std::io::Read;
fn main() {
    let mut text = String::new();
    std::io::stdin().read_to_string(&mut text).unwrap();
    let mut files = Files::default();
    let id = files.add("in", text.clone());
    let (file, ds) = hrdsl_syntax::parse(id, &text);
    if std::env::args().len() > 1 { println!("{:#?}", file); }
    println!("{} items, {} errors", file.items.len(), file.items.iter().filter(|i| i.kind == hrdsl_syntax::ast::ItemKind::Error).count());
    for d in ds {
        println!("{} {} [{}] {} {:?}", files.place(d.span()), d.code, files.text(d.span()), d.message, d.help);
        for l in &d.labels[1..] { println!("     {} [{}] {}", files.place(l.span), files.text(l.span), l.text); }
    }
}
