//! The library's modules, and which uses which.

use std::collections::{BTreeMap, BTreeSet};

use crate::tokens::{closing, is_word, tokens};

/// The modules of a library, as their files declare them. Those that only tests have are none.
#[derive(Default)]
pub(crate) struct Source {
    /// The paths that each file names, in the module in which they stand.
    files: BTreeMap<String, Vec<(String, Vec<String>)>>,
    /// Files whose folder is named after them.
    contents: BTreeSet<String>,
    /// Modules, in files and in braces.
    modules: BTreeSet<String>,
    /// What names stand for that `use` brings into a module.
    names: BTreeMap<String, (String, Vec<String>)>,
    /// Modules all of whose names a module has.
    globs: BTreeMap<String, Vec<Vec<String>>>,
}

/// Names that lead in a circle are given up after so many steps.
const STEPS: usize = 16;

impl Source {
    /// Reads `lib.rs`, and what is declared there and below. `read` has the text of a file.
    pub(crate) fn read(read: &dyn Fn(&str) -> Option<String>) -> Self {
        let mut source = Self::default();
        source.file("", "lib.rs", true, read);
        source
    }

    fn file(&mut self, module: &str, file: &str, contents: bool, read: &dyn Fn(&str) -> Option<String>) {
        let Some(text) = read(file) else { panic!("{module} is declared, and {file} is missing") };
        self.files.insert(module.to_owned(), Vec::new());
        if contents {
            self.contents.insert(module.to_owned());
        }
        self.code(module, module, &tokens(&text), read);
    }

    /// Reads the code of a module that stands in the file of a module.
    fn code(&mut self, file: &str, module: &str, code: &[String], read: &dyn Fn(&str) -> Option<String>) {
        self.modules.insert(module.to_owned());
        let mut at = 0;
        while at < code.len() {
            let token = |ahead: usize| code.get(at + ahead).map_or("", String::as_str);
            let name = || join(module, token(1));
            match (token(0), token(2)) {
                ("#", _) if token(1) == "[" => {
                    let end = closing(code, at + 1);
                    let is_test = is_for_tests(&code[at + 2..end.min(code.len())]);
                    at = if is_test { item_end(code, end + 1) } else { end + 1 };
                }
                ("mod", ";") => {
                    let path = name().replace("::", "/");
                    let table = format!("{path}/mod.rs");
                    if read(&table).is_some() {
                        self.file(&name(), &table, true, read);
                    } else {
                        self.file(&name(), &format!("{path}.rs"), false, read);
                    }
                    at += 3;
                }
                ("mod", "{") => {
                    let end = closing(code, at + 2);
                    self.code(file, &name(), &code[at + 3..end.min(code.len())], read);
                    at = end + 1;
                }
                ("use", _) => {
                    let mut found = Vec::new();
                    at = imports(code, at + 1, &[], &mut found);
                    for (path, name) in found {
                        self.import(file, module, path, &name);
                    }
                }
                (first, _) if is_word(first) && token(1) == "::" => {
                    let (path, end) = path(code, at);
                    self.files.get_mut(file).expect("a file").push((module.to_owned(), path));
                    at = end;
                }
                _ => at += 1,
            }
        }
    }

    fn import(&mut self, file: &str, module: &str, path: Vec<String>, name: &str) {
        if name == "*" {
            self.globs.entry(module.to_owned()).or_default().push(path.clone());
        } else {
            self.names.insert(join(module, name), (module.to_owned(), path.clone()));
        }
        self.files.get_mut(file).expect("a file").push((module.to_owned(), path));
    }

    /// Whether a module's file lists what is in its folder.
    pub(crate) fn is_table_of_contents(&self, module: &str) -> bool {
        self.contents.contains(module)
    }

    /// Which file uses which, by their modules.
    pub(crate) fn arrows(&self) -> BTreeMap<String, BTreeSet<String>> {
        let uses = |(file, paths): (&String, &Vec<(String, Vec<String>)>)| {
            let homes = paths.iter().filter_map(|(module, path)| self.home(module, path, STEPS));
            let files = homes.map(|home| self.file_of(home)).filter(|used| used != file);
            (file.clone(), files.collect())
        };
        self.files.iter().map(uses).collect()
    }

    /// The module whose file holds a module.
    fn file_of(&self, mut module: String) -> String {
        while !self.files.contains_key(&module) {
            module = parent(&module);
        }
        module
    }

    /// The module that defines what a path in a module names. `None` for what is not the library's.
    fn home(&self, module: &str, path: &[String], steps: usize) -> Option<String> {
        let (first, rest) = path.split_first()?;
        let mut at = match first.as_str() {
            "crate" | "roverlab" => String::new(),
            "self" => module.to_owned(),
            "super" => parent(module),
            _ => return self.named(module, path, steps),
        };
        for (index, name) in rest.iter().enumerate() {
            match name.as_str() {
                "super" => at = parent(&at),
                "self" | "*" => {}
                _ => return self.named(&at, &rest[index..], steps).or(Some(at)),
            }
        }
        Some(at)
    }

    /// The same for a path that begins with a name which a module has.
    fn named(&self, module: &str, path: &[String], steps: usize) -> Option<String> {
        let steps = steps.checked_sub(1)?;
        let (first, rest) = path.split_first()?;
        let full = join(module, first);
        if self.modules.contains(&full) {
            return if rest.is_empty() { Some(full) } else { self.named(&full, rest, steps).or(Some(full)) };
        }
        if let Some((from, target)) =
            self.names.get(&full).filter(|(_, target)| target.as_slice() != std::slice::from_ref(first))
        {
            return self.home(from, &[target, rest].concat(), steps);
        }
        let globs = self.globs.get(module).into_iter().flatten();
        globs.filter_map(|glob| self.home(module, glob, steps)).find_map(|all| self.named(&all, path, steps))
    }
}

/// A path below a module.
fn join(module: &str, name: &str) -> String {
    if module.is_empty() { name.to_owned() } else { format!("{module}::{name}") }
}

fn parent(module: &str) -> String {
    module.rsplit_once("::").map_or("", |(parent, _)| parent).to_owned()
}

/// Whether an attribute is one of what only tests have: `cfg(test)`, or `cfg(all(test, …))`.
fn is_for_tests(attribute: &[String]) -> bool {
    let words: Vec<&str> = attribute.iter().map(String::as_str).collect();
    words.starts_with(&["cfg", "(", "test", ")"]) || words.starts_with(&["cfg", "(", "all", "(", "test", ","])
}

/// Where an item ends, with the attributes that it may have.
fn item_end(code: &[String], mut at: usize) -> usize {
    while at < code.len() {
        match code[at].as_str() {
            ";" | "," => return at + 1,
            "{" => return closing(code, at) + 1,
            "(" | "[" => at = closing(code, at) + 1,
            _ => at += 1,
        }
    }
    at
}

/// The path that begins here, and where it ends.
fn path(code: &[String], mut at: usize) -> (Vec<String>, usize) {
    let mut path = vec![code[at].clone()];
    at += 1;
    while code.get(at).is_some_and(|token| token == "::") {
        let Some(name) = code.get(at + 1).filter(|token| is_word(token) || *token == "*") else { break };
        path.push(name.clone());
        at += 2;
    }
    (path, at)
}

/// The paths that a `use` brings, each with its name there. Returns where it ends.
fn imports(code: &[String], at: usize, before: &[String], found: &mut Vec<(Vec<String>, String)>) -> usize {
    let (mut path, mut at) = match code.get(at).map(String::as_str) {
        Some("{") => (Vec::new(), at),
        // A path of another crate, or nothing.
        Some("::") | None => return at + 1,
        Some(_) => self::path(code, at),
    };
    path.splice(..0, before.iter().cloned());
    let token = |at: usize| code.get(at).map_or("", String::as_str);
    if token(at) == "::" {
        at += 1;
    }
    if token(at) == "{" {
        at += 1;
        while at < code.len() && token(at) != "}" {
            at = if token(at) == "," { at + 1 } else { imports(code, at, &path, found) };
        }
        return at + 1;
    }
    if path.last().is_some_and(|name| name == "self") && path.len() > 1 {
        path.pop();
    }
    let renamed = token(at) == "as";
    let name = if renamed { token(at + 1).to_owned() } else { path.last().cloned().unwrap_or_default() };
    found.push((path, name));
    if renamed { at + 2 } else { at }
}
