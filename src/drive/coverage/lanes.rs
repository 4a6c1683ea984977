use super::CoverageMap;
use crate::geometry::Point;

/// A part of the floor covered by adjacent lanes, each given by its two ends.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Block {
    pub(super) lanes: Vec<[Point; 2]>,
}

/// Free run of a lane: its first and last column, or row.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Run {
    first: usize,
    last: usize,
    block: usize,
}

/// Divides the reachable cells into blocks of lanes along x or y (boustrophedon decomposition, H. Choset and
/// P. Pignon, "Coverage path planning: the boustrophedon cellular decomposition", 1997). A new block begins
/// where an obstacle splits or joins lanes.
pub(super) fn blocks(map: &CoverageMap, along_x: bool) -> Vec<Block> {
    let raster = map.raster();
    let (length, count) =
        if along_x { (raster.columns(), raster.rows()) } else { (raster.rows(), raster.columns()) };
    let cell = |along: usize, lane: usize| {
        if along_x { lane * raster.columns() + along } else { along * raster.columns() + lane }
    };
    let parameters = map.parameters();
    let spacing = 2.0 * parameters.radius - parameters.overlap;
    let lanes = lanes(
        count,
        |lane| (0..length).any(|along| map.places[cell(along, lane)]),
        spacing / raster.resolution(),
    );
    let mut blocks: Vec<Block> = Vec::new();
    let mut before: Vec<Run> = Vec::new();
    for lane in lanes {
        let mut runs = runs(length, |along| map.places[cell(along, lane)]);
        for at in 0..runs.len() {
            let meets = |run: &Run, other: &Run| run.first <= other.last && other.first <= run.last;
            let run = runs[at];
            let above: Vec<&Run> = before.iter().filter(|other| meets(&run, other)).collect();
            // A run that continues exactly one other stays in its block.
            let alone = above.len() == 1 && runs.iter().filter(|other| meets(other, above[0])).count() == 1;
            let block = if alone {
                above[0].block
            } else {
                blocks.push(Block { lanes: Vec::new() });
                blocks.len() - 1
            };
            runs[at].block = block;
            let ends = [run.first, run.last].map(|along| raster.centre(cell(along, lane)));
            blocks[block].lanes.push(ends);
        }
        before = runs;
    }
    blocks
}

/// Rows, or columns, of the lanes, evenly spaced between the first and the last one the robot can reach.
fn lanes(count: usize, is_used: impl Fn(usize) -> bool, spacing: f64) -> Vec<usize> {
    let used: Vec<usize> = (0..count).filter(|&lane| is_used(lane)).collect();
    let [first, .., last] = used.as_slice() else { return used };
    let gaps = ((last - first) as f64 / spacing).ceil().max(1.0);
    (0..=gaps as usize).map(|k| first + ((last - first) as f64 * k as f64 / gaps).round() as usize).collect()
}

fn runs(length: usize, is_free: impl Fn(usize) -> bool) -> Vec<Run> {
    let mut runs: Vec<Run> = Vec::new();
    for along in 0..length {
        if !is_free(along) {
            continue;
        }
        match runs.last_mut().filter(|run| run.last + 1 == along) {
            Some(run) => run.last = along,
            None => runs.push(Run { first: along, last: along, block: 0 }),
        }
    }
    runs
}
