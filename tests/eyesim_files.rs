//! Walks the tables of `docs/eyesim-files.md`: what is *used* changes what is read, and what is *reported*
//! gives a warning.

use roverlab::world::formats::{MemoryFiles, esobj, maz, parse_scene, robi, wld};

const TABLES: &str = include_str!("../docs/eyesim-files.md");

/// A row of a table.
struct Row<'t> {
    format: &'t str,
    /// The lines of its example; the last one is the one that it is about.
    lines: Vec<String>,
    used: bool,
}

fn rows() -> Vec<Row<'static>> {
    let mut format = "";
    let mut rows = Vec::new();
    for line in TABLES.lines() {
        if let Some(heading) = line.strip_prefix("## ") {
            format = heading.trim_matches('`');
        }
        let line = line.replace("\\|", "\u{1}");
        let cells: Vec<&str> = line.split('|').map(str::trim).collect();
        let [_, _, example, here @ ("used" | "reported"), ..] = cells.as_slice() else { continue };
        let lines = example.split('`').skip(1).step_by(2).map(|code| code.replace('\u{1}', "|")).collect();
        rows.push(Row { format, lines, used: *here == "used" });
    }
    rows
}

fn files() -> MemoryFiles {
    let pixel = || b"P6 1 1 255 abc".to_vec();
    let text = |text: &str| text.as_bytes().to_vec();
    let list = [
        ("room.wld", text("floor 3000 3000\n")),
        ("maze.maz", text(" _ _\n|a .|\n|_ _|\n")),
        ("cart.robi", text("drive DIFFERENTIAL_DRIVE\nwheel 54 3600 1100 45\n")),
        ("sign.esObj", text("box 0 50 0 100 100 20\n")),
        ("plate.obj", text("v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n")),
        ("carpet.png", pixel()),
        ("hills.png", b"P6 2 2 255 abcdefabcxyz".to_vec()),
    ];
    MemoryFiles(list.into_iter().map(|(name, bytes)| (name.into(), bytes)).collect())
}

/// What a text of a format says, and how many warnings there are about it.
fn read(format: &str, text: &str) -> (String, Vec<String>) {
    let scene = |name: &str, script: &str| {
        let mut files = files();
        files.0.insert(name.into(), text.as_bytes().to_vec());
        let parsed =
            parse_scene(script.as_bytes().to_vec(), "test.sim", &mut files).unwrap_or_else(|e| panic!("{e}"));
        (format!("{:?}", parsed.value), parsed.warnings.iter().map(ToString::to_string).collect())
    };
    match format {
        ".sim" => scene("unused", text),
        ".wld" => scene("test.wld", "world test.wld\n"),
        ".maz" => scene("test.maz", "world test.maz\n"),
        ".robi" => scene("test.robi", "robot test.robi\ntest 500 500 0\nCart 500 500 0\n"),
        ".esObj" => scene("test.esObj", "object test.esObj\ntest 500 500 0\nPlate 500 500 0\n"),
        other => panic!("a table of {other}"),
    }
}

/// A whole text around some lines.
fn around(format: &str, lines: &[String]) -> String {
    let lines = lines.join("\n");
    match format {
        ".wld" => format!("floor 2000 2000\n{lines}\n0 0 2000 0\n"),
        ".maz" => format!(" _ _\n|_ _|\n{}\n", if lines.is_empty() { "|. .|" } else { &lines }),
        ".robi" => format!("drive DIFFERENTIAL_DRIVE\nwheel 54 3600 1100 45\n{lines}\n"),
        ".esObj" => format!("collider box 0 50 0 100 100 100\n{lines}\n"),
        _ => format!("S4 100 100 0\n{lines}\n"),
    }
}

#[test]
fn what_is_used_changes_something_and_what_is_not_is_reported() {
    let rows = rows();
    let mut wrong = Vec::new();
    for Row { format, lines, used } in &rows {
        let (last, before) = lines.split_last().expect("a row has an example");
        let (with, warnings) = read(format, &around(format, lines));
        let (without, fewer) = read(format, &around(format, before));
        let new: Vec<_> = warnings.iter().filter(|warning| !fewer.contains(warning)).collect();
        let number = around(format, lines).lines().position(|line| line == last).unwrap() + 1;
        let place = format!(":{number}:");
        let right = if *used {
            with != without && !new.iter().any(|warning| warning.contains(&place))
        } else {
            new.iter().any(|warning| warning.contains(&place))
        };
        if !right {
            wrong.push(format!(
                "{format} `{last}`: {}; {warnings:?}",
                if *used { "used" } else { "reported" }
            ));
        }
    }
    assert!(wrong.is_empty(), "{wrong:#?}");
    // Exact, so that rows which are no longer understood are noticed.
    let count = |format: &str| rows.iter().filter(|row| row.format == format).count();
    assert_eq!([".sim", ".wld", ".maz", ".robi", ".esObj"].map(count), [17, 21, 10, 48, 16]);
}

/// The words that the readers tell apart, as their source text has them.
#[test]
fn the_tables_have_every_word_that_the_readers_know() {
    let sources = [
        include_str!("../src/world/formats/sim/read.rs"),
        include_str!("../src/world/formats/wld.rs"),
        include_str!("../src/world/formats/robi/read.rs"),
        include_str!("../src/world/formats/esobj.rs"),
    ];
    let mut found = 0;
    for arm in
        sources.iter().flat_map(|source| source.lines()).filter_map(|line| line.trim().split_once("=>"))
    {
        let words: Vec<&str> = arm.0.split('|').map(str::trim).collect();
        let quoted = |word: &&str| word.len() > 3 && word.starts_with('"') && word.ends_with('"');
        if !words.iter().all(quoted) {
            continue;
        }
        for word in words.iter().map(|word| word.trim_matches('"')) {
            found += 1;
            let says = |mark: &str| TABLES.contains(&format!("{mark}{word}"));
            assert!(says("`") || says(" "), "{word} is in no table");
        }
    }
    assert!(found > 40, "{found}");
}

/// Readers of one file alone say the same as those of whole scenes.
#[test]
fn single_files_are_reported_too() {
    assert_eq!(wld::parse("floor 9 9\nball 1 2\n", "a.wld").unwrap().warnings.len(), 1);
    assert_eq!(esobj::parse("box 0 5 0 1 1 1\nsofa 2\n", "a.esObj").unwrap().warnings.len(), 1);
    assert_eq!(robi::parse("drive OMNI_DRIVE\nmodel a.obj\n", "a.robi").unwrap().warnings.len(), 2);
    assert!(maz::parse(" _\n|_|\n", "a.maz").unwrap().warnings.is_empty());
}
