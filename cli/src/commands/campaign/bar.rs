//! The bar of whatever takes long; it is there on a terminal only.

use indicatif::{ProgressBar, ProgressStyle};

/// A bar for so many things, which are called `what`.
pub fn progress_bar(count: usize, what: &str) -> ProgressBar {
    let bar = ProgressBar::new(count as u64);
    let template = "{bar:32} {pos}/{len} {prefix}  {elapsed} (about {eta} left)  {msg}";
    if let Ok(style) = ProgressStyle::with_template(template) {
        bar.set_style(style);
    }
    bar.with_prefix(what.to_owned())
}
