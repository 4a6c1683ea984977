//! What the source itself has to keep to.

use std::fs;
use std::path::{Path, PathBuf};

/// All Rust files below a folder.
fn rust_files(folder: &Path, found: &mut Vec<PathBuf>) {
    for entry in fs::read_dir(folder).unwrap() {
        let path = entry.unwrap().path();
        if path.is_dir() {
            rust_files(&path, found);
        } else if path.extension().is_some_and(|ending| ending == "rs") {
            found.push(path);
        }
    }
}

/// Otherwise each run would draw cases of its own, and fail for somebody who has changed nothing.
#[test]
fn every_property_draws_the_same_cases_for_everybody() {
    let mut files = Vec::new();
    let folders =
        ["src", "tests", "cli", "robios"].map(|name| Path::new(env!("CARGO_MANIFEST_DIR")).join(name));
    // A published package has no members.
    for folder in folders.iter().filter(|folder| folder.is_dir()) {
        rust_files(folder, &mut files);
    }
    let (mut properties, opening) = (0, ["proptest", "! {"].concat());
    for file in files {
        let text = fs::read_to_string(&file).unwrap();
        for (block, next) in
            text.lines().zip(text.lines().skip(1)).filter(|(line, _)| line.ends_with(&opening))
        {
            properties += 1;
            let file = file.display();
            assert!(next.contains("cases("), "{file}: `{block}` is followed by `{next}`");
        }
    }
    assert!(properties > 100, "{properties} were found");
}

/// A doc that two constants share leaves the unit and the origin of one of them to guesses.
#[test]
fn every_constant_with_a_figure_has_a_doc_of_its_own() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("src");
    let mut files = Vec::new();
    rust_files(&root, &mut files);
    let (mut constants, mut bare) = (0, Vec::new());
    for file in files {
        let text = fs::read_to_string(&file).unwrap();
        let lines: Vec<&str> = text.lines().collect();
        for (at, line) in lines.iter().enumerate() {
            let Some((before, rest)) = line.split_once("const ") else { continue };
            let kind = rest.split_once(": ").and_then(|(_, kind)| kind.split('=').next()).unwrap_or("");
            let words = || kind.split(|c: char| !c.is_alphanumeric());
            let figure = words().any(|word| ["f64", "f32", "usize", "Duration"].contains(&word));
            if !(figure && (before.is_empty() || before.starts_with("pub")) && !rest.starts_with("fn ")) {
                continue;
            }
            constants += 1;
            let above = lines[..at].iter().rev().find(|line| !line.starts_with("#["));
            if !above.is_some_and(|line| line.starts_with("///")) {
                bare.push(format!("{}:{}: {line}", file.display(), at + 1));
            }
        }
    }
    assert!(bare.is_empty(), "without a doc of its own:\n{}", bare.join("\n"));
    assert!(constants > 700, "{constants} were found");
}

/// Longer, and nobody reads to its end.
#[test]
fn the_front_page_stays_short() {
    let page = fs::read_to_string(Path::new(env!("CARGO_MANIFEST_DIR")).join("README.md")).unwrap();
    let lines = page.lines().count();
    assert!(lines <= 120, "README.md has {lines} lines; expected at most 120");
}

/// Pages in Markdown below a folder.
fn pages(folder: &Path, found: &mut Vec<PathBuf>) {
    for entry in fs::read_dir(folder).unwrap() {
        let path = entry.unwrap().path();
        if path.is_dir() {
            pages(&path, found);
        } else if path.extension().is_some_and(|ending| ending == "md") {
            found.push(path);
        }
    }
}

/// The anchors of a page, as web sites make them of its headings.
fn anchors(page: &str) -> impl Iterator<Item = String> {
    let headings = page.lines().filter(|line| line.starts_with('#'));
    headings.map(|line| {
        let words = line.trim_start_matches('#').trim().to_lowercase().replace(' ', "-");
        words.chars().filter(|c| c.is_alphanumeric() || *c == '-' || *c == '_').collect()
    })
}

#[test]
fn links_of_pages_lead_somewhere() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let mut files = vec![root.join("README.md"), root.join("CONTRIBUTING.md"), root.join("CHANGELOG.md")];
    pages(&root.join("docs"), &mut files);
    let mut links = 0;
    for file in files {
        let text = fs::read_to_string(&file).unwrap();
        for link in text.split("](").skip(1).filter_map(|rest| rest.split([')', ' ']).next()) {
            let (path, anchor) = link.split_once('#').unwrap_or((link, ""));
            let target = if path.is_empty() { file.clone() } else { file.parent().unwrap().join(path) };
            // A published package lacks pictures and benchmarks.
            let left_out = !root.join(".ci").is_dir() && !target.exists();
            if link.contains("://") || left_out {
                continue;
            }
            assert!(target.exists(), "{}: {link}", file.display());
            let known = anchor.is_empty()
                || anchors(&fs::read_to_string(&target).unwrap()).any(|heading| heading == anchor);
            assert!(known, "{}: {link} names no heading", file.display());
            links += 1;
        }
    }
    assert!(links > 50, "only {links} links were found");
}
