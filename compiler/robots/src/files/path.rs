//! Paths as texts: joined by `/`, without what goes up and down again.

/// A path from a folder; one that begins at the root stays as it is.
pub(crate) fn joined(folder: &str, path: &str) -> String {
    if path.starts_with('/') || folder.is_empty() {
        normal(path)
    } else {
        normal(&format!("{folder}/{path}"))
    }
}

/// The folder of a file; empty if the path has none.
pub(crate) fn folder_of(path: &str) -> &str {
    match path.rsplit_once('/') {
        Some(("", _)) => "/",
        Some((folder, _)) => folder,
        None => "",
    }
}

/// What stands after the last dot of the last part, in lower case.
pub(crate) fn ending_of(path: &str) -> String {
    let name = path.rsplit('/').next().unwrap_or_default();
    name.rsplit_once('.').map_or_else(String::new, |(_, ending)| ending.to_ascii_lowercase())
}

/// Without `.`, without empty parts, and without `..` where something stands before it.
pub(crate) fn normal(path: &str) -> String {
    let mut parts: Vec<&str> = Vec::new();
    for part in path.split('/').filter(|part| !part.is_empty() && *part != ".") {
        match (part, parts.last()) {
            ("..", Some(&last)) if last != ".." => {
                parts.pop();
            }
            ("..", None) if path.starts_with('/') => {}
            _ => parts.push(part),
        }
    }
    let start = if path.starts_with('/') { "/" } else { "" };
    format!("{start}{}", parts.join("/"))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn paths_are_joined_and_shortened() {
        assert_eq!(joined("a/b", "../c/./d.stl"), "a/c/d.stl");
        assert_eq!(joined("a", "../../c"), "../c");
        assert_eq!(joined("a", "/c//d/.."), "/c");
        assert_eq!(joined("", "c/d"), "c/d");
        assert_eq!(normal("/../a"), "/a");
        assert_eq!((folder_of("a/b.urdf"), folder_of("/b"), folder_of("b")), ("a", "/", ""));
        assert_eq!((ending_of("a.b/C.STL"), ending_of("a.b/c")), ("stl".to_owned(), String::new()));
    }
}
