//! The fault matrix: what each behaviour does with each kind of fault, held against `docs/faults.md`.
//! `REGENERATE=1 cargo test --all-features --test control` writes the table there anew.

use std::path::Path;

use roverlab::geometry::{Aabb, Point};
use roverlab::io::RobotTruth;
use roverlab::io::sim::{SimOptions, Simulation};
use roverlab::io::wrappers::Faulty;
use roverlab::world::{DriveSpec, HeightField, RobotSpec, Scene, Terrain, World};

use super::cases::{CASES, Case, START, room};

/// Columns of the table, and the faults of all sensors from 2 s on.
const FAULTS: [(&str, &str); 9] = [
    ("none", ""),
    ("stuck", "stuck@2"),
    ("lost", "lost@2"),
    ("nan", "nan@2"),
    ("jump", "jump=500,0,90@2"),
    ("late", "late=0.5@2"),
    ("link", "link@2"),
    ("hang", "hang=3@2"),
    ("clock", "clock@2"),
];
/// Duration of a run (s): enough to get to a wall.
const LIMIT: f64 = 18.0;

/// The room, or a pool for craft: 8 m x 8 m, 1.9 m deep.
fn world_for(spec: &RobotSpec) -> World {
    if !matches!(spec.drive, DriveSpec::Craft(_)) {
        return room();
    }
    let area = Aabb::new(Point::origin(), Point::new(8.0, 8.0));
    let rim = |at: Point| {
        let inside = at.x.min(8.0 - at.x).min(at.y).min(8.0 - at.y);
        if inside > 0.25 { 0.0 } else { 2.0 }
    };
    let surface = HeightField::from_fn(161, 161, area, rim).unwrap();
    let terrain = Some(Terrain::new("pool.png", surface));
    World { terrain, water_level: Some(1.9), ..World::empty(8.0, 8.0) }
}

/// What came of a run with a fault.
fn cell((_, spec, run): &Case, fault: &str) -> String {
    let (spec, options) = (spec(), SimOptions { trail_interval: Some(0.5), ..SimOptions::ideal() });
    let scene = Scene::with_robot(world_for(&spec), spec, START);
    let simulation = Simulation::new(&scene, options).unwrap();
    let faults = if fault.is_empty() { Vec::new() } else { vec![fault.parse().unwrap()] };
    let mut robot = Faulty::new(simulation.robot(0).unwrap(), faults);
    let outcome = run(&mut robot, LIMIT, f64::INFINITY);
    let truth = simulation.truth().robot(0).unwrap();
    let end = match outcome {
        Err(_) => "error".to_owned(),
        Ok(outcome) if outcome != "TimedOut" => outcome,
        Ok(_) if is_moving(&truth) => "drives".to_owned(),
        Ok(_) => "stands".to_owned(),
    };
    if truth.contacts > 0 { end + ", hits" } else { end }
}

/// Whether a robot has moved in the last two seconds of its run.
fn is_moving(truth: &RobotTruth) -> bool {
    let before = truth.trail.iter().find(|point| point.time >= LIMIT - 2.0).map(|point| point.pose);
    before.is_some_and(|before| {
        truth.pose.distance_to(before.position()) > 0.02 || (truth.pose.heading - before.heading).abs() > 0.05
    })
}

fn matrix() -> Vec<String> {
    let row = |cells: Vec<&str>| format!("| {} |", cells.join(" | "));
    let mut rows = vec![
        row([&["behaviour"][..], &FAULTS.map(|(name, _)| name)].concat()),
        row(vec!["---"; FAULTS.len() + 1]),
    ];
    for case in CASES {
        let cells = FAULTS.map(|(_, fault)| cell(case, fault));
        rows.push(row([case.0].into_iter().chain(cells.iter().map(String::as_str)).collect()));
    }
    rows
}

/// No behaviour drives on by what is no reading. `docs/faults.md` says what it does with readings that may be
/// true.
#[test]
fn the_fault_matrix_is_as_documented() {
    let file = Path::new(env!("CARGO_MANIFEST_DIR")).join("docs/faults.md");
    let text = std::fs::read_to_string(&file).unwrap();
    let found = matrix();
    println!("{}", found.join("\n"));
    if std::env::var_os("REGENERATE").is_some() {
        let (before, table) = text.split_once("| behaviour").unwrap();
        let after = table.lines().skip_while(|line| line.starts_with("| ") || line.contains(" | "));
        let after: Vec<&str> = after.collect();
        std::fs::write(&file, format!("{before}{}\n{}\n", found.join("\n"), after.join("\n"))).unwrap();
    } else {
        let table: Vec<&str> = text.lines().filter(|line| line.starts_with("| ")).collect();
        assert_eq!(found, table, "REGENERATE=1 writes it anew, if this is meant");
    }
    for row in found.iter().skip(2) {
        let cells: Vec<&str> = row.trim_matches('|').split('|').map(str::trim).collect();
        for (column, cell) in FAULTS.iter().map(|(name, _)| name).zip(&cells[1..]) {
            let ends = ["lost", "nan", "link", "clock"].contains(column);
            assert!(!ends || !cell.starts_with("drives") || READS_NOTHING.contains(&cells[0]), "{row}");
        }
    }
}

/// Behaviours that decide without readings: only a robot that no longer answers ends them.
const READS_NOTHING: [&str; 1] = ["gait"];
