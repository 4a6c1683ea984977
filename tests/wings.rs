//! Which part of the library may use which: what `docs/ARCHITECTURE.md` says, held against the paths in the
//! source. Tests and comments are left out.

use std::collections::{BTreeMap, BTreeSet};
use std::fs;
use std::path::Path;

/// What each wing may use. All of it stands further up, so arrows between wings point down and in no circle.
const WINGS: [(&str, &str); 18] = [
    ("geometry", ""),
    ("random", "geometry"),
    ("kinematics", "geometry random"),
    ("world", "geometry random"),
    ("vision", "geometry random"),
    ("picture", "geometry world"),
    ("io", "geometry random kinematics world"),
    ("io::sim", "geometry random kinematics world io"),
    // It simulates to check that a program does the same again.
    ("io::log", "geometry random world io io::sim"),
    ("io::robios", "geometry world io"),
    ("scan", "geometry random kinematics world io"),
    ("drive", "geometry random kinematics world vision io scan"),
    ("maze", "geometry random kinematics world io drive"),
    ("nav", "geometry random kinematics world io scan"),
    ("race", "geometry random kinematics world vision io"),
    ("safety", "geometry random kinematics world io"),
    ("evolve", "geometry random kinematics world picture io"),
    ("testing", "geometry random world maze nav race"),
];

/// Files that use each other. Each line is one thing in several files, and no line may be added without need.
const CIRCLES: [&str; 6] = [
    "maze::fast::bound maze::fast::search",
    "maze::flood::register maze::flood::wave",
    "world::body world::object world::robot",
    "world::generate::decor world::generate::room",
    "world::grid world::scene",
    "world::space::shape world::space::solid",
];

/// The code of each module by its path, and the modules that are a folder's table of contents.
#[derive(Default)]
struct Source {
    code: BTreeMap<String, String>,
    contents: BTreeSet<String>,
}

impl Source {
    fn read(&mut self, folder: &Path, module: &str) {
        for entry in fs::read_dir(folder).unwrap() {
            let path = entry.unwrap().path();
            let name = path.file_stem().unwrap().to_str().unwrap();
            if name == "tests" || name.ends_with("_tests") {
                continue;
            }
            if path.is_dir() {
                self.read(&path, &join(module, name));
            } else if name == "mod" || name == "lib" {
                self.contents.insert(module.to_owned());
                self.code.insert(module.to_owned(), code(&fs::read_to_string(&path).unwrap()));
            } else {
                self.code.insert(join(module, name), code(&fs::read_to_string(&path).unwrap()));
            }
        }
    }

    /// The module where something is defined: names that a table of contents hands on are followed.
    fn home(&self, path: &str, handed: &BTreeMap<String, String>) -> String {
        let mut path = path.to_owned();
        'handed: loop {
            let mut module = String::new();
            for name in path.split("::") {
                let inner = join(&module, name);
                match handed.get(&inner).filter(|target| !self.code.contains_key(&inner) && **target != inner)
                {
                    Some(target) => path = path.replacen(&inner, target, 1),
                    None if self.code.contains_key(&inner) => {
                        module = inner;
                        continue;
                    }
                    None => break 'handed module,
                }
                continue 'handed;
            }
            break module;
        }
    }

    /// Which module uses which.
    fn arrows(&self) -> BTreeMap<&str, BTreeSet<String>> {
        let mut handed = BTreeMap::new();
        for module in &self.contents {
            for (at, found) in self.code[module].match_indices(" use ") {
                for path in paths(&self.code[module][at + found.len()..]).0 {
                    let name = join(module, path.rsplit("::").next().unwrap());
                    handed.insert(name, absolute(module, &path));
                }
            }
        }
        let uses = |(module, code): (&'_ String, &String)| -> BTreeSet<String> {
            let starts = ["crate::", "super::", "self::"].iter().flat_map(|start| code.match_indices(start));
            let whole = starts.filter(|(at, _)| !code[..*at].ends_with(|c: char| is_name(c) || c == ':'));
            let named = whole.flat_map(|(at, _)| paths(&code[at..]).0);
            named
                .map(|path| self.home(&absolute(module, &path), &handed))
                .filter(|used| used != module)
                .collect()
        };
        self.code.iter().map(|entry| (entry.0.as_str(), uses(entry))).collect()
    }
}

fn join(module: &str, name: &str) -> String {
    if module.is_empty() { name.to_owned() } else { format!("{module}::{name}") }
}

fn is_name(c: char) -> bool {
    c.is_alphanumeric() || c == '_'
}

/// A file without its comments and tests, in one line.
fn code(text: &str) -> String {
    let (mut code, mut lines) = (String::new(), text.lines());
    while let Some(line) = lines.next() {
        if ["#[cfg(test)]", "#[cfg(all(test,"].iter().any(|test| line.trim_start().starts_with(test)) {
            // An item of one line, or one that ends with a brace below its first letter.
            let item = lines.find(|line| !line.trim_start().starts_with("#[")).unwrap_or_default();
            let end = format!("{}}}", &item[..item.len() - item.trim_start().len()]);
            if !item.ends_with([';', '}']) {
                lines.find(|line| *line == end);
            }
        } else {
            code.extend([" ", line.split("//").next().unwrap_or_default()]);
        }
    }
    code
}

/// The paths that begin here, one for each name in braces, and the code behind them.
fn paths(code: &str) -> (Vec<String>, &str) {
    let code = code.trim_start();
    let Some(mut rest) = code.strip_prefix('{') else {
        let (name, rest) = code.split_at(code.find(|c| !is_name(c)).unwrap_or(code.len()));
        let Some(inner) = rest.strip_prefix("::").filter(|rest| rest.starts_with(|c| is_name(c) || c == '{'))
        else {
            return (vec![name.to_owned()], rest);
        };
        let (found, rest) = paths(inner);
        return (found.iter().map(|path| join(name, path)).collect(), rest);
    };
    let mut found = Vec::new();
    loop {
        let (more, after) = paths(rest);
        found.extend(more);
        match after.find([',', '}']) {
            Some(at) if after[at..].starts_with(',') => rest = &after[at + 1..],
            Some(at) => return (found, &after[at + 1..]),
            None => return (found, after),
        }
    }
}

/// A path from the root of the library.
fn absolute(module: &str, path: &str) -> String {
    let mut base: Vec<&str> = module.split("::").filter(|name| !name.is_empty()).collect();
    for name in path.split("::") {
        match name {
            "crate" => base.clear(),
            "super" => drop(base.pop()),
            "self" | "" => {}
            name => base.push(name),
        }
    }
    base.join("::")
}

fn wing(module: &str) -> &str {
    let backends = ["io::sim", "io::log", "io::robios"];
    let backend =
        backends.into_iter().find(|&wing| module == wing || module.starts_with(&format!("{wing}::")));
    backend.unwrap_or(module.split("::").next().unwrap())
}

fn source() -> Source {
    let mut source = Source::default();
    source.read(&Path::new(env!("CARGO_MANIFEST_DIR")).join("src"), "");
    source
}

#[test]
fn arrows_between_wings_point_down() {
    let mut known = BTreeMap::new();
    for (wing, uses) in WINGS {
        let uses: Vec<&str> = uses.split_whitespace().collect();
        assert!(uses.iter().all(|used| known.contains_key(used)), "{wing} uses what stands further down");
        known.insert(wing, uses);
    }
    for (module, uses) in source().arrows().into_iter().filter(|(module, _)| !module.is_empty()) {
        let may = known.get(wing(module)).unwrap_or_else(|| panic!("{module} is in no wing of the table"));
        for used in uses.iter().filter(|used| !used.is_empty() && wing(used) != wing(module)) {
            assert!(may.contains(&wing(used)), "{module} uses {used}; it may use {may:?}");
        }
    }
}

#[test]
fn files_use_each_other_in_no_new_circle() {
    let source = source();
    let mut reached = source.arrows();
    // Tables of contents name all that is below them.
    reached.retain(|module, _| !source.contents.contains(*module));
    let files: Vec<&str> = reached.keys().copied().collect();
    for through in &files {
        let onwards = reached[through].clone();
        for uses in reached.values_mut().filter(|uses| uses.contains(*through)) {
            uses.extend(onwards.iter().cloned());
        }
    }
    let circle = |file: &&str| {
        let both =
            files.iter().filter(|other| reached[*file].contains(**other) && reached[*other].contains(*file));
        both.copied().collect::<Vec<_>>().join(" ")
    };
    let circles: BTreeSet<String> = files.iter().map(circle).filter(|circle| !circle.is_empty()).collect();
    assert_eq!(circles, CIRCLES.into_iter().map(String::from).collect());
}
