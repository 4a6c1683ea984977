//! What the documentation says of traits, modules, errors and outcomes is so in the source.

use std::collections::{BTreeMap, BTreeSet};
use std::fs;
use std::path::{Path, PathBuf};

fn source() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("src")
}

fn text(file: &str) -> String {
    fs::read_to_string(source().join(file)).unwrap()
}

/// All Rust files of the library, with their paths relative to `src`.
fn files() -> Vec<(String, String)> {
    let (mut folders, mut found) = (vec![source()], Vec::new());
    while let Some(folder) = folders.pop() {
        for entry in fs::read_dir(folder).unwrap() {
            let path = entry.unwrap().path();
            if path.is_dir() {
                folders.push(path);
            } else if path.extension().is_some_and(|ending| ending == "rs") && !path.ends_with("tests.rs") {
                let name = path.strip_prefix(source()).unwrap().to_str().unwrap().replace('\\', "/");
                found.push((name, fs::read_to_string(&path).unwrap()));
            }
        }
    }
    found.sort();
    found
}

/// The part of a text between two others.
fn between<'t>(text: &'t str, before: &str, after: &str) -> Option<&'t str> {
    text.split_once(before)?.1.split_once(after).map(|(part, _)| part)
}

type Traits = BTreeSet<String>;

/// The traits in a bound such as `Odometry + Lidar + ?Sized`.
fn traits(bound: &str) -> Traits {
    bound.split(['+', ',']).map(str::trim).filter(|name| !name.starts_with('?')).map(String::from).collect()
}

/// The bound of a robot's type in the head of an implementation or a function.
fn robot(head: &str) -> Traits {
    let bound = between(head, "R: ", ">").unwrap_or("?Sized");
    // Further type parameters follow after a comma.
    traits(bound.split(',').next().unwrap())
}

/// What the source demands of a robot, by the behaviour.
fn demanded(files: &[(String, String)]) -> BTreeMap<String, Traits> {
    let lines = || files.iter().flat_map(|(_, text)| text.lines());
    let name = |line: &str| {
        let name = line.split(" for ").nth(1).unwrap();
        String::from(name.split(['<', ' ']).next().unwrap())
    };
    let commands: BTreeMap<String, Traits> = lines()
        .filter(|line| line.starts_with("impl") && line.contains(" Command<R> for "))
        .map(|line| (name(line), robot(line)))
        .collect();
    let mut moves: BTreeMap<String, Traits> = BTreeMap::new();
    let mut behaviour = None;
    for line in lines().map(str::trim) {
        if line.starts_with("impl") && line.contains("Behaviour for ") {
            behaviour = Some(name(line));
        } else if let (Some(command), Some(by)) = (between(line, "type Command = ", ";"), &behaviour) {
            let command = command.rsplit("::").next().unwrap().split('<').next().unwrap();
            moves.insert(by.clone(), commands.get(command).cloned().unwrap_or_default());
        }
    }
    let mut demanded = BTreeMap::new();
    for (_, text) in files {
        let mut of = String::new();
        let mut heads = text.lines().peekable();
        while let Some(line) = heads.next() {
            let code = line.trim();
            if let Some(named) = line.strip_prefix("impl ") {
                of = named.split(['<', ' ']).next().unwrap().into();
            }
            if code.starts_with("impl<R: ") && code.contains(" Senses<R> for ") {
                let by = name(code);
                demanded.insert(by.clone(), &robot(code) | &moves.get(&by).cloned().unwrap_or_default());
            } else if code.starts_with("pub fn ") && !code.contains("->") {
                let mut head = String::from(code);
                while !head.contains('{') && heads.peek().is_some() {
                    head += heads.next().unwrap();
                }
                if head.contains("impl Senses<R,") {
                    let function = between(&head, "pub fn ", "<").unwrap();
                    let command = between(&head, "Command = ", ",").unwrap();
                    demanded.insert(format!("{of}::{function}"), &robot(&head) | &commands[command]);
                }
            }
        }
    }
    by_other_names(files, &commands, &mut demanded);
    demanded.into_iter().filter(|(_, traits)| !traits.is_empty()).collect()
}

/// The behaviours that macros and generic implementations stand for.
fn by_other_names(
    files: &[(String, String)],
    commands: &BTreeMap<String, Traits>,
    demanded: &mut BTreeMap<String, Traits>,
) {
    let racers = demanded.remove("$racer").unwrap();
    for (_, text) in files {
        for racer in text.lines().filter_map(|line| between(line, "races!(", ",")) {
            demanded.insert(racer.into(), &racers | &commands["Twist"]);
        }
    }
    let bugs = demanded.remove("B").unwrap();
    demanded.insert("Bug".into(), &bugs | &commands["Twist"]);
    let gait = commands["ServoPositions"].clone();
    demanded.insert("GaitWalk".into(), gait);

    let lines = || files.iter().flat_map(|(_, text)| text.lines());
    let readings: BTreeMap<&str, Traits> = lines()
        .filter(|line| line.starts_with("impl<R: ") && line.contains(" WallReading<R> for "))
        .map(|line| (between(line, " for ", " {").unwrap(), robot(line)))
        .collect();
    let mut controller = None;
    for line in lines() {
        if let Some(name) = line.strip_prefix("impl FollowsWalls for ") {
            controller = name.strip_suffix(" {");
        } else if let (Some(seen), Some(name)) =
            (between(line, "type Observation = ", ";"), controller.take())
        {
            let own = &traits("StallDetector") | &commands["Twist"];
            demanded.insert(format!("AlongWall<{name}>"), &own | &readings[seen]);
        }
    }
    let runner =
        lines().find(|line| line.starts_with("impl<'r, R: ") && line.ends_with(" MazeRunner<'r, R> {"));
    let mut runner = robot(runner.unwrap());
    assert!(runner.remove("Clock"));
    demanded.insert("MazeRunner".into(), runner);
}

/// The names in backticks.
fn quoted(cell: &str) -> impl Iterator<Item = &str> {
    cell.split('`').skip(1).step_by(2)
}

#[test]
fn the_table_of_traits_is_what_behaviours_demand() {
    let page = text("io/mod.rs");
    let table = between(&page, "//! | behaviour | traits |\n", "\n\n").unwrap();
    let mut listed = BTreeMap::new();
    for row in table.lines().skip(1) {
        let cells: Vec<&str> = row.split('|').collect();
        let needs: Traits = quoted(cells[2]).map(String::from).collect();
        for behaviour in quoted(cells[1]) {
            listed.insert(String::from(behaviour), needs.clone());
        }
    }
    let demanded = demanded(&files());
    for (behaviour, traits) in &demanded {
        assert_eq!(listed.get(behaviour), Some(traits), "src/io/mod.rs: the traits of {behaviour}");
    }
    let stale: Vec<&String> = listed.keys().filter(|name| !demanded.contains_key(*name)).collect();
    assert!(stale.is_empty(), "src/io/mod.rs lists {stale:?}, which need nothing or are no more");
    assert!(listed.len() > 20, "{listed:?}");
}

#[test]
fn traits_say_what_implementers_must_do() {
    let mut all = 0;
    for (file, text) in files() {
        for (at, line) in text.match_indices("\npub trait ") {
            let name = text[at + line.len()..].split(|c: char| !c.is_alphanumeric()).next().unwrap();
            let docs: Vec<&str> = text[..at]
                .lines()
                .rev()
                .take_while(|line| line.starts_with("///") || line.starts_with('#'))
                .collect();
            assert!(docs.contains(&"/// # For implementers"), "src/{file}: the trait {name}");
            all += 1;
        }
    }
    assert!(all > 30, "{all} traits");
}

#[test]
fn every_public_module_is_named_on_the_front_page() {
    let page = text("lib.rs");
    let page = page.split("#![cfg_attr").next().unwrap();
    let named: BTreeSet<&str> = quoted(page).collect();
    let mut all = 0;
    for (file, text) in files() {
        let folder = file.strip_suffix("/mod.rs").unwrap_or_else(|| file.trim_end_matches(".rs"));
        let above = if file == "lib.rs" { String::new() } else { format!("{folder}/") };
        for module in text.lines().filter_map(|line| line.strip_prefix("pub mod ")?.strip_suffix(';')) {
            let path = format!("{above}{module}").replace('/', "::");
            // The formats are listed in `world::formats`.
            if !path.starts_with("world::formats::") {
                assert!(named.contains(path.as_str()), "src/lib.rs does not name the module {path}");
                all += 1;
            }
        }
    }
    assert!(all > 35, "{all} modules");
}

#[test]
fn each_chapter_has_a_page_of_the_guide_whose_programs_run() {
    let guide = source().join("../docs/guide");
    let summary = fs::read_to_string(guide.join("SUMMARY.md")).unwrap();
    let tested = text("lib.rs");
    let mut chapters = BTreeSet::new();
    for page in fs::read_dir(&guide).unwrap() {
        let path = page.unwrap().path();
        let name = path.file_name().unwrap().to_str().unwrap();
        if path.extension().is_none_or(|ending| ending != "md") || name == "SUMMARY.md" {
            continue;
        }
        let text = fs::read_to_string(&path).unwrap();
        assert!(summary.contains(&format!("]({name})")), "docs/guide/SUMMARY.md does not list {name}");
        let included = tested.contains(&format!("include_str!(\"../docs/guide/{name}\")"));
        assert!(included || !text.contains("```rust"), "src/lib.rs does not run the programs of {name}");
        let of = between(&text, "*Chapter", " of the book.*").unwrap_or_default();
        chapters
            .extend(of.split(|c: char| !c.is_ascii_digit()).filter_map(|number| number.parse::<u32>().ok()));
    }
    assert!((1..=14).all(|chapter| chapters.contains(&chapter)), "chapters with a page: {chapters:?}");
}

/// The public types of a file, each with what it derives.
fn types(text: &str) -> Vec<(&str, &str)> {
    let lines: Vec<&str> = text.lines().collect();
    let typed = lines.iter().enumerate().filter_map(|(at, line)| {
        let rest = line.strip_prefix("pub struct ").or_else(|| line.strip_prefix("pub enum "))?;
        let name = rest.split(|c: char| !c.is_alphanumeric()).next()?;
        let above = lines[..at].iter().rev().take_while(|line| !line.is_empty());
        Some((name, above.copied().find(|line| line.starts_with("#[derive")).unwrap_or("")))
    });
    typed.collect()
}

#[test]
fn errors_end_a_main_with_a_sentence_and_outcomes_have_one() {
    let files = files();
    let whole: String = files.iter().map(|(_, text)| text.as_str()).collect();
    let (mut errors, mut outcomes) = (0, 0);
    for (file, text) in &files {
        for (name, derive) in types(text) {
            let derives = |word: &str| derive.split(|c: char| !c.is_alphanumeric()).any(|part| part == word);
            if derives("Error") || text.contains(&format!("error::Error for {name} {{")) {
                let sentence = ["debug_as_sentence!(", "impl<N: std::fmt::Debug> std::fmt::Debug for "]
                    .iter()
                    .any(|start| text.contains(&format!("{start}{name}")));
                assert!(sentence && !derives("Debug"), "src/{file}: `main` prints {name} as a structure");
                errors += 1;
            }
            if name.ends_with("Outcome") {
                let shown = whole.contains(&format!("halts!({name} "))
                    || whole.contains(&format!("Display for {name} "));
                assert!(shown, "src/{file}: {name} has no `Display`");
                outcomes += 1;
            }
        }
    }
    assert!(errors >= 17 && outcomes >= 17, "{errors} errors, {outcomes} outcomes");
}
