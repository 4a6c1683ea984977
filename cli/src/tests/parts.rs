//! Campaigns in parts: the merged report is that of the whole, to the byte.

use std::fs;
use std::path::PathBuf;

use super::support::{DATA, said, temporary, text};
use crate::commands::{COMMANDS, Command};

/// Short campaigns, one for each command that has parts.
fn campaigns() -> Vec<String> {
    let mazes = format!("micromouse --campaign {DATA}/mazes --runs 2");
    [
        "a-to-b --campaign --runs 2",
        "boat --campaign --runs 3 --time-limit 20",
        "bug-compare --campaign --runs 2 --bugs bug2,distbug",
        "color-tracking --campaign --scenes 3",
        "cone-drive --campaign 3 --time-limit 5",
        "cone-race --campaign 3 --laps 1 --time-limit 5",
        "cone-race --campaign 2 --rival gap --time-limit 5",
        "coverage --campaign --rooms 2 --time-limit 20",
        "distbug --campaign --worlds 2 --levels 0,1",
        "dive --campaign --runs 3",
        "first-steps --campaign --runs 3",
        "follow-me --campaign --runs 1 --time-limit 10",
        "lane-keeping --campaign --courses 2 --minutes 0.05",
        "localise --campaign --starts 1 --patience 1",
        &mazes,
        "motion --campaign --approach --scenes 3",
        "navigate --campaign --runs 2 --time-limit 20",
        "parking --campaign --runs 2 --time-limit 5",
        "ping --campaign --runs 3",
        "pool-search --campaign --runs 2 --time-limit 10",
        "pool-wall --campaign --runs 3 --time-limit 20",
        "ramp --campaign --runs 2 --time-limit 20",
        "random-drive --campaign --runs 4 --time-limit 5",
        "summit --campaign --runs 2 --time-limit 20",
        "survey --campaign --runs 3 --time-limit 20",
        "terrain-plan --campaign --runs 1",
        "traffic --campaign --runs 2 --time-limit 2",
        "wall-following --campaign --rooms 2",
    ]
    .map(str::to_owned)
    .to_vec()
}

/// What a command line says.
fn says(line: &str, more: &[&str]) -> (u8, String, String) {
    let words: Vec<&str> = line.split(' ').chain(more.iter().copied()).collect();
    said(words[0], &words[1..])
}

/// The files of a campaign's parts.
fn parts(line: &str, of: usize, name: &str) -> Vec<PathBuf> {
    let part = |number: usize| {
        let file = temporary(&format!("part-{name}-{number}.jsonl"));
        let (share, threads) = (format!("{number}/{of}"), number.to_string());
        let mut more = vec!["--part", &share, "--out", text(&file)];
        if line.starts_with("ramp") {
            more.extend(["--threads", &threads]);
        }
        let (status, out, err) = says(line, &more);
        assert_eq!((status, err.as_str()), (0, ""), "{line} {share}: {out}");
        assert!(out.contains("part_done"), "{line} {share}: {out}");
        file
    };
    (1..=of).map(part).collect()
}

fn merged(files: &[PathBuf], more: &[&str]) -> (u8, String, String) {
    let files: Vec<&str> = files.iter().map(|file| text(file)).collect();
    said("merge", &[&files[..], more].concat())
}

/// The error of a merge that fails.
fn refused(files: &[PathBuf]) -> String {
    let (status, out, err) = merged(files, &[]);
    assert_eq!((status, out.as_str(), err.lines().count()), (2, "", 1), "{err}");
    err
}

#[test]
fn a_merged_report_is_that_of_the_whole() {
    let line = "random-drive --campaign --runs 7 --time-limit 5 --seed 3";
    let mut files = parts(line, 3, "whole");
    files.reverse();
    assert_eq!(merged(&files, &["--json"]), says(line, &["--json"]));
    assert_eq!(merged(&files, &[]), says(line, &[]));
    let (_, timed, _) = merged(&files, &["--json", "--timing"]);
    assert!(timed.contains("wall_time_s"), "{timed}");
}

#[test]
fn more_parts_than_runs_leave_some_empty() {
    let line = "random-drive --campaign --runs 2 --time-limit 5";
    assert_eq!(merged(&parts(line, 3, "few"), &["--json"]), says(line, &["--json"]));
}

#[test]
fn every_campaign_in_parts_is_equal_to_the_whole() {
    let campaigns = campaigns();
    for command in COMMANDS.iter().filter(|command| command.has_parts()) {
        let name = command.name.replace('_', "-");
        assert!(campaigns.iter().any(|line| line.split(' ').next() == Some(&name)), "no campaign of {name}");
    }
    for (index, line) in campaigns.iter().enumerate() {
        let files = parts(line, 2, &format!("each-{index}"));
        let (whole, joined) = (says(line, &["--json"]), merged(&files, &["--json"]));
        assert!(whole.1.contains("\"outcome\""), "{line}: {whole:?}");
        assert_eq!(joined, whole, "{line}");
    }
}

#[test]
fn campaigns_have_parts() {
    let has = |command: &&Command, name: &str| command.options().iter().any(|option| option == name);
    let without = COMMANDS.iter().filter(|command| has(command, "campaign") && !command.has_parts());
    // Its option --out is for weights; `lane-keeping --driver net` runs the same campaign.
    assert_eq!(without.map(|command| command.name).collect::<Vec<_>>(), ["end_to_end"]);
}

#[test]
fn single_runs_have_no_parts() {
    for command in COMMANDS.iter().filter(|command| command.has_parts()) {
        let (status, _, err) = said(command.name, &["--part", "1/2", "--out", "part.jsonl"]);
        assert_eq!(status, 2, "{}: {err}", command.name);
        assert!(err.contains("--part") || err.contains("campaign"), "{}: {err}", command.name);
    }
}

#[test]
fn a_part_writes_nothing_but_its_results() {
    let line = "distbug --campaign --worlds 2 --part 1/2 --out part.jsonl --save folder";
    let (status, _, err) = says(line, &[]);
    assert_eq!(status, 2);
    assert!(err.contains("--save: has no meaning with --part"), "{err}");
    let (status, _, err) = says("ramp --campaign --part 3/2 --out part.jsonl", &[]);
    assert_eq!(status, 2);
    assert!(err.contains("3/2") && err.contains("expected K/N"), "{err}");
    let (status, _, err) = says("ramp --campaign --part 1/2", &[]);
    assert_eq!(status, 2);
    assert!(err.contains("--out"), "{err}");
}

#[test]
fn the_campaign_writes_its_files_when_it_is_merged() {
    let folder = temporary("part-saved");
    let files = parts("distbug --campaign --worlds 2 --levels 0", 2, "saving");
    let (status, _, err) = merged(&files, &["--json", "--", "--save", text(&folder)]);
    assert_eq!((status, err.as_str()), (0, ""));
    assert!(folder.is_dir());
}

#[test]
fn parts_that_do_not_fit_are_refused() {
    let line = "random-drive --campaign --runs 4 --time-limit 2";
    let files = parts(line, 3, "fit");
    let fit = |line: &str, name: &str| parts(line, 3, name)[1].clone();
    let other = |second: PathBuf| vec![files[0].clone(), second, files[2].clone()];
    let missing = refused(&files[..2]);
    assert!(missing.contains("found 2 of 3 parts; expected part 3/3 as well"), "{missing}");
    let twice = refused(&other(files[0].clone()));
    assert!(twice.contains("line 1: found part 1/3 again; expected another one"), "{twice}");
    let count = refused(&other(parts(line, 2, "two")[1].clone()));
    assert!(count.contains("found part 2/2; expected one of 3 parts"), "{count}");
    let seed = refused(&other(fit(&format!("{line} --seed 5"), "seed")));
    assert!(seed.contains("found results with the options `") && seed.contains("--seed=5"), "{seed}");
    let command = refused(&other(fit("ramp --campaign --runs 4", "ramp")));
    assert!(command.contains("found results of the command ramp; expected random_drive"), "{command}");
}

#[test]
fn broken_files_are_refused() {
    let files = parts("random-drive --campaign --runs 5 --time-limit 2", 2, "broken");
    let good = fs::read_to_string(&files[0]).unwrap();
    let lines: Vec<&str> = good.lines().collect();
    let broken = temporary("part-broken.jsonl");
    let says = |bytes: &[u8]| {
        fs::write(&broken, bytes).unwrap();
        let first = refused(&[broken.clone(), files[1].clone()]);
        assert!(first.contains("part-broken.jsonl"), "{first}");
        first
    };
    let with = |from: &str, to: &str| says(good.replace(from, to).as_bytes());
    let cases = [
        (says(b""), "line 1: found an empty file; expected the header"),
        (says(b"\xff\xfe"), "line 1: found no JSON of the header"),
        (says(b"{\"roverlab_part\": 1}\n"), "line 1: found no JSON of the header"),
        (says(&vec![b'x'; 2 << 20]), "line 1: found a line of more than 1048576 bytes"),
        (says(&[b"[".repeat(100_000), b"\n".to_vec()].concat()), "line 1: found no JSON"),
        (with("roverlab_part\":1", "roverlab_part\":2"), "found version 2 of the format; expected version 1"),
        (with("\"version\":\"", "\"version\":\"9"), "found results of version 9"),
        (with("\"part\":\"1/2\"", "\"part\":\"7/2\""), "part \"7/2\": expected K/N"),
        (with("random_drive", "replay"), "found no campaign that runs in parts"),
        (with("random_drive", "systems"), "found no campaign that runs in parts"),
        (with("--time-limit=2", "--picture=/tmp/x.svg"), "found the option \"--picture=/tmp/x.svg\""),
        (with("--time-limit=2", "x"), "found the option \"x\"; expected options that affect results"),
        (with("--time-limit=2", "--"), "found the option \"--\"; expected options that affect results"),
        (says(format!("{}\n", lines[..2].join("\n")).as_bytes()), "line 3: found the end of the file"),
        (says(&good.as_bytes()[..good.len() - 9]), "line 4: found no JSON of a result"),
        (says(format!("{good}{}\n", lines[2]).as_bytes()), "line 5: found another line"),
        (
            says([lines[0], lines[2], lines[1], lines[3]].join("\n").as_bytes()),
            "line 2: found the result of run 2",
        ),
        (with("{\"run\":2", "{\"run\":2,\"more\":1"), "line 3: found no JSON of a result"),
        (with("\"result\":[", "\"result\":[\"one\","), "line 2: result: found a list, expected a list of 2"),
    ];
    for (found, expected) in cases {
        assert!(found.contains(expected), "{found} has not: {expected}");
    }
    fs::remove_file(&broken).unwrap();
    let absent = refused(&[broken]);
    assert!(absent.contains("expected a file that --part and --out wrote"), "{absent}");
    assert!(refused(&[PathBuf::from("/dev/zero")]).contains("is a device"));
}
