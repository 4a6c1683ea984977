//! What all maps say together.

use std::fmt::Write as _;

use crate::compare::Result;
use crate::table::{
    ALL, ANY_ANGLE, GRID_PATHFINDING, GRID_PATHFINDING_PLAIN, JPS, JPS_PLUS, PATHFINDING, POLYANYA, QUADTREE,
};

/// Figures of warthog, a C++ library (D. Harabor), that were measured on another day beside `pathfinding`'s
/// A\* on the same maps: microseconds of the median query of that A\*, of its jump point search without
/// preparation, and of jps2+.
const WARTHOG: [(&str, f64, f64, f64); 10] = [
    ("arena2.map", 245.0, 10.0, 5.8),
    ("32room_000.map", 3600.0, 37.0, 13.0),
    ("Aftershock.map", 1345.0, 32.0, 19.0),
    ("London_1_512.map", 1105.0, 35.0, 20.0),
    ("maze512-4-0.map", 17647.0, 431.0, 253.0),
    ("orz900d.map", 8364.0, 231.0, 155.0),
    ("random512-25-0.map", 2699.0, 2451.0, 2320.0),
    ("20 % scattered, 512 x 512", 1188.0, 922.0, 852.0),
    ("rooms, 512 x 512", 2636.0, 92.0, 42.0),
    ("cave, 1024 x 1024", 3789.0, 408.0, 403.0),
];

/// Ratios over the maps of 512 cells and more.
pub(crate) fn summary(results: &[Result]) -> String {
    let mut text =
        String::from("\ngeometric means over the maps of 512 cells and more, medians of queries:\n");
    let large: Vec<&Result> = results.iter().filter(|result| result.is_large).collect();
    if large.is_empty() {
        return text + "  none\n";
    }
    for entry in ALL.iter().filter(|entry| entry.is_ours) {
        let over = |peers: &[&str]| mean(large.iter().filter_map(|result| faster(result, entry.name, peers)));
        let worst = results.iter().filter_map(|result| faster(result, entry.name, &[PATHFINDING]));
        let _ = writeln!(
            text,
            "  {:<26}{:>8.2} times as fast as {PATHFINDING} (worst map {:.2}), {:.2} {GRID_PATHFINDING}, {:.2} {POLYANYA}",
            entry.name,
            over(&[PATHFINDING]),
            worst.fold(f64::INFINITY, f64::min),
            over(&[GRID_PATHFINDING, GRID_PATHFINDING_PLAIN]),
            over(&[POLYANYA]),
        );
    }
    warthog(&mut text, &large);
    quality(&mut text, results);
    text
}

/// How many times as fast a planner is as the fastest of some others.
fn faster(result: &Result, name: &str, others: &[&str]) -> Option<f64> {
    let fastest = others.iter().filter_map(|other| result.median(other)).reduce(f64::min)?;
    Some(fastest / result.median(name)?)
}

#[allow(clippy::disallowed_methods, reason = "for a table that people read")]
fn mean(ratios: impl Iterator<Item = f64>) -> f64 {
    let logs: Vec<f64> = ratios.map(f64::ln).collect();
    (logs.iter().sum::<f64>() / logs.len() as f64).exp()
}

/// Times in terms of warthog's, each in terms of the A\* of its own run.
fn warthog(text: &mut String, large: &[&Result]) {
    let mut ratios = (Vec::new(), Vec::new());
    text.push_str("\ntimes in terms of warthog's, each in terms of pathfinding's A* of its own run:\n");
    for &(map, astar, jps, jps2_plus) in &WARTHOG {
        let Some(result) = large.iter().find(|result| result.map == map) else { continue };
        let in_terms = |name: &str, theirs: f64| {
            Some(result.median(name)? / result.median(PATHFINDING)? / (theirs / astar))
        };
        let (Some(online), Some(prepared)) = (in_terms(JPS, jps), in_terms(JPS_PLUS, jps2_plus)) else {
            continue;
        };
        let _ = writeln!(text, "  {map:<28}{online:>6.2} of jps, {prepared:.2} of jps2+");
        ratios.0.push(online);
        ratios.1.push(prepared);
    }
    if !ratios.0.is_empty() {
        let (online, prepared) = (mean(ratios.0.into_iter()), mean(ratios.1.into_iter()));
        let _ = writeln!(text, "  {:<28}{online:>6.2} of jps, {prepared:.2} of jps2+", "geometric mean");
    }
}

/// A table for each kind of map: medians by planner and by size, and in brackets the milliseconds to get
/// ready.
pub(crate) fn growth(results: &[Result]) -> String {
    // Names are those of kinds, and sizes after them.
    let kind = |result: &Result| result.map.split(',').next().unwrap_or_default().to_owned();
    let size = |result: &Result| result.map.split(' ').next_back().unwrap_or_default().to_owned();
    let mut kinds: Vec<String> = results.iter().map(kind).collect();
    kinds.sort();
    kinds.dedup();
    let mut text = String::new();
    for name in kinds {
        let of_kind: Vec<&Result> = results.iter().filter(|result| kind(result) == name).collect();
        let sizes: Vec<String> = of_kind.iter().map(|result| size(result)).collect();
        let _ = writeln!(text, "\n| {name}, us (ready in ms) | {} |", sizes.join(" | "));
        let _ = writeln!(text, "|---|{}", "---|".repeat(sizes.len()));
        for (row, column) in of_kind[0].columns.iter().enumerate() {
            let cell = |result: &&Result| {
                let column = &result.columns[row];
                format!("{:.0} ({:.1})", column.median, column.prepare_ms)
            };
            let cells: Vec<String> = of_kind.iter().map(cell).collect();
            let _ = writeln!(text, "| {} | {} |", column.entry.name, cells.join(" | "));
        }
    }
    text
}

/// How long paths through quadtrees are.
fn quality(text: &mut String, results: &[Result]) {
    let columns = results.iter().flat_map(|result| result.columns.iter());
    let quadtree: Vec<(f64, f64)> =
        columns.filter(|column| column.entry.name == QUADTREE).map(|column| column.quality).collect();
    let mean = quadtree.iter().map(|quality| quality.0).sum::<f64>() / quadtree.len().max(1) as f64;
    let worst = quadtree.iter().map(|quality| quality.1).fold(0.0, f64::max);
    let _ = writeln!(
        text,
        "\npaths through quadtrees: {mean:.4} times those of {ANY_ANGLE} on average over the maps; on the worst map 99 % \
         below {worst:.4}"
    );
}
