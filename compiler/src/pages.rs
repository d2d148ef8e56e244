//! The pages of the diagnostic codes, embedded: what `hrdsl explain` prints.

use hrdsl_source::DiagnosticCode;

/// `(code, text)`, in the order of the codes; made by the build script from `spec/codes/`.
const PAGES: &[(u16, &str)] = include!(concat!(env!("OUT_DIR"), "/pages.rs"));

/// The page of a code, as Markdown.
#[must_use]
pub fn page(code: DiagnosticCode) -> Option<&'static str> {
    PAGES.binary_search_by_key(&code.0, |p| p.0).ok().map(|at| PAGES[at].1)
}

/// Where the page of a code is in the project.
#[must_use]
pub fn path(code: DiagnosticCode) -> String {
    format!("spec/codes/{code}.md")
}

#[cfg(test)]
mod tests {
    use hrdsl_source::REGISTRY;

    use super::*;

    #[test]
    fn every_code_has_its_page() {
        for info in REGISTRY {
            let page = page(info.code).unwrap_or_default();
            assert!(page.starts_with(&format!("# {}: {}\n", info.code, info.title)), "{}", info.code);
        }
        assert_eq!(PAGES.len(), REGISTRY.len());
        assert_eq!(page(DiagnosticCode(9999)), None);
    }
}
