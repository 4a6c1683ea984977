//! Every public algorithm has a documentation example that runs.
//!
//! An algorithm is a public function, or a public structure with a constructor of its own or with one of
//! [`ALGORITHM_TRAITS`]; parameters and errors are none. Its example is a block of code that runs and names
//! it (an import does not count), in the documentation of the same file or of a module that contains it.

use std::collections::BTreeSet;
use std::fs;
use std::path::{Path, PathBuf};

/// Structures that implement one of these count even without a constructor.
const ALGORITHM_TRAITS: [&str; 9] = [
    "Behaviour",
    "Bug",
    "Crossover",
    "Evaluator",
    "Evolution",
    "Explorer",
    "GridPlanner",
    "Mutation",
    "Station",
];

/// Algorithms without an example: file, names, reason. The list may only shrink: whatever gets an example
/// leaves it.
const EXCEPTIONS: &[(&str, &str, &str)] = &[
    ("evolve/processes.rs", "Processes serve", "needs child processes"),
    ("io/robios/robot.rs", "RobiosRobot", "needs the RoBIOS library of a robot"),
];

fn source() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("src")
}

/// All Rust files below a folder, with their paths relative to `src`.
fn rust_files(folder: &Path, found: &mut Vec<(String, String)>) {
    for entry in fs::read_dir(folder).unwrap() {
        let path = entry.unwrap().path();
        if path.is_dir() {
            rust_files(&path, found);
        } else if path.extension().is_some_and(|ending| ending == "rs") {
            let name = path.strip_prefix(source()).unwrap().to_str().unwrap().replace('\\', "/");
            found.push((name, fs::read_to_string(&path).unwrap()));
        }
    }
}

fn words(text: &str) -> impl Iterator<Item = &str> {
    text.split(|c: char| !c.is_alphanumeric() && c != '_').filter(|word| !word.is_empty())
}

/// The words in the running examples of a file, without those of imports and comments.
fn named_in_examples(text: &str) -> BTreeSet<String> {
    let (mut named, mut runs, mut imports) = (BTreeSet::new(), None, false);
    for line in text.lines() {
        let line = line.trim_start();
        let Some(doc) = line.strip_prefix("///").or_else(|| line.strip_prefix("//!")) else {
            runs = None;
            continue;
        };
        let code = doc.trim_start().trim_start_matches("# ");
        if let Some(label) = code.strip_prefix("```") {
            runs = if runs.is_some() { None } else { Some(["", "rust", "should_panic"].contains(&label)) };
        } else if runs == Some(true) {
            let code = code.split("//").next().unwrap();
            imports |= code.starts_with("use ");
            if !imports {
                named.extend(words(code).map(String::from));
            }
            imports &= !code.contains(';');
        }
    }
    named
}

/// The type that an `impl` line is for, and the trait that it implements.
fn implemented(line: &str) -> Option<(&str, Option<&str>)> {
    let rest = line.strip_prefix("impl")?;
    let rest = if rest.starts_with('<') { after_generics(rest) } else { rest };
    let (of, name) = rest.split_once(" for ").map_or((None, rest), |(of, name)| (Some(of), name));
    let of = of.map(|of| words(of.split('<').next().unwrap()).last().unwrap());
    Some((words(name).next()?, of))
}

/// What follows the generics that a text begins with.
fn after_generics(text: &str) -> &str {
    let mut depth = 0;
    for (at, letter) in text.char_indices() {
        depth += match letter {
            '<' => 1,
            '>' if !text[..at].ends_with('-') => -1,
            _ => 0,
        };
        if depth == 0 {
            return &text[at + 1..];
        }
    }
    ""
}

/// Whether the head of a function says that it makes a value of its own type from others.
fn is_constructor(head: &str) -> bool {
    let Some((arguments, returned)) = head.rsplit_once(" -> ") else { return false };
    let receives = words(arguments.split_once('(').map_or("", |(_, arguments)| arguments)).take(3);
    words(returned).any(|word| word == "Self") && !receives.into_iter().any(|word| word == "self")
}

/// The names of the structures that behave: they have a constructor or one of the traits.
fn behaving(text: &str) -> BTreeSet<&str> {
    let (mut found, mut current) = (BTreeSet::new(), None);
    let mut lines = text.lines();
    while let Some(line) = lines.next() {
        if let Some((name, of)) = implemented(line) {
            current = of.is_none().then_some(name);
            if of.is_some_and(|of| ALGORITHM_TRAITS.contains(&of)) {
                found.insert(name);
            }
        } else if line.starts_with("    pub fn ") || line.starts_with("    pub const fn ") {
            let mut head = String::from(line);
            while !head.contains('{') && !head.contains(" where") {
                head += lines.next().unwrap();
            }
            if is_constructor(&head) {
                found.extend(current);
            }
        }
    }
    found
}

/// The algorithms that a file defines. What is `pub` in the first column is public: the lint
/// `unreachable_pub` sees to it.
fn algorithms(text: &str, behaving: &BTreeSet<&str>) -> Vec<String> {
    let declared = |line: &str| {
        let rest = line.strip_prefix("pub ")?;
        let rest = rest.strip_prefix("const ").unwrap_or(rest);
        let (kind, rest) = rest.split_once(' ')?;
        let name = words(rest).next()?;
        let is_value = name.ends_with("Parameters") || name.ends_with("Error");
        let counts = match kind {
            "fn" => true,
            "struct" | "enum" => behaving.contains(name) && !is_value,
            _ => false,
        };
        counts.then(|| String::from(name))
    };
    text.lines().filter_map(declared).collect()
}

/// A file and the modules that contain it, nearest first.
fn places(file: &str) -> impl Iterator<Item = String> {
    let folders = file.match_indices('/').map(|(at, _)| &file[..at]).collect::<Vec<_>>();
    let modules =
        folders.into_iter().rev().flat_map(|folder| [format!("{folder}/mod.rs"), format!("{folder}.rs")]);
    std::iter::once(String::from(file)).chain(modules.collect::<Vec<_>>())
}

#[test]
fn every_public_algorithm_has_an_example_that_runs() {
    let mut files = Vec::new();
    rust_files(&source(), &mut files);
    let examples = files
        .iter()
        .map(|(file, text)| (file.clone(), named_in_examples(text)))
        .collect::<std::collections::BTreeMap<_, _>>();
    let behaving = files.iter().flat_map(|(_, text)| behaving(text)).collect();
    let (mut all, mut without) = (0, BTreeSet::new());
    for (file, text) in &files {
        for name in algorithms(text, &behaving) {
            all += 1;
            let shown =
                places(file).any(|place| examples.get(&place).is_some_and(|named| named.contains(&name)));
            if !shown {
                without.insert((file.as_str(), name));
            }
        }
    }
    let excepted = EXCEPTIONS
        .iter()
        .flat_map(|(file, names, _)| names.split(' ').map(move |name| (*file, String::from(name))))
        .collect::<BTreeSet<_>>();
    println!("{} of {all} algorithms have an example", all - without.len());
    let missing = without.difference(&excepted).collect::<Vec<_>>();
    assert!(missing.is_empty(), "no example that runs names these: {missing:#?}");
    let stale = excepted.difference(&without).collect::<Vec<_>>();
    assert!(stale.is_empty(), "these have an example, or are gone, and leave the exceptions: {stale:#?}");
    assert!(all > 300, "only {all} algorithms were found");
}

#[test]
fn examples_that_do_not_run_and_imports_name_nothing() {
    let named = |text| named_in_examples(text).into_iter().collect::<Vec<_>>();
    assert_eq!(named("/// ```\n/// use a::{b,\n///     c};\n/// # d(1); // e\n/// ```\n/// f"), ["1", "d"]);
    assert_eq!(named("/// ```no_run\n/// a();\n/// ```\n/// b\n/// ```\n/// c();\n/// ```"), ["c"]);
}

#[test]
fn structures_count_by_constructors_and_traits() {
    let text = "impl<F: Fn(f64) -> f64> A<F> {\n    pub fn new(\n        f: F,\n    ) -> Result<Self> {\n    }\n}\n\
                impl B {\n    pub fn turned(&self) -> Self {\n    }\n}\n\
                impl<G> crate::evolve::Mutation<G> for C {\n}\nimpl Default for D {\n}\n";
    assert_eq!(behaving(text), BTreeSet::from(["A", "C"]));
}
