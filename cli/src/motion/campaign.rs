use image::GrayImage;
use roverlab::geometry::units;
use roverlab::io::{self, Camera, Clock};
use roverlab::vision::motion::{MotionDetector, MotionParameters};
use serde_json::json;

use super::watch::bearing;
use super::{Args, scene};
use crate::common::{Failure, Outcome, Report, rounded};

/// Time between the two images of a pair (s), and number of pairs per scene.
const APART: f64 = 0.1;
const IN_A_SCENE: u64 = 20;
/// Number of still pairs per allowed alarm.
const RATE: u64 = 1000;
/// The book's threshold (Program 11.14).
const BOOK: f64 = 15.0;

/// Measures of image pairs: largest change of a block, and mean difference.
#[derive(Debug, Clone, Default)]
pub(crate) struct Pairs {
    pub(crate) still: Vec<[f64; 2]>,
    pub(crate) moving: Vec<[f64; 2]>,
}

/// Performance of a threshold: alarms in still pairs, and detected fraction of moving ones.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Roc {
    pub(crate) threshold: f64,
    pub(crate) false_alarms: usize,
    pub(crate) detected: f64,
}

impl Pairs {
    /// Performance of a threshold on one of the two measures.
    pub(crate) fn at(&self, measure: usize, threshold: f64) -> Roc {
        let above = |pairs: &[[f64; 2]]| pairs.iter().filter(|pair| pair[measure] > threshold).count();
        let detected = above(&self.moving) as f64 / self.moving.len().max(1) as f64;
        Roc { threshold, false_alarms: above(&self.still), detected }
    }

    /// The lowest threshold with at most `alarms` alarms.
    pub(crate) fn best(&self, measure: usize, alarms: usize) -> Roc {
        let mut values: Vec<f64> = self.still.iter().map(|pair| pair[measure]).collect();
        values.sort_by(|a, b| b.total_cmp(a));
        self.at(measure, values.get(alarms).copied().unwrap_or(0.0))
    }
}

/// Compares many pairs of images.
pub(crate) fn campaign(args: &Args) -> Result<Report, Failure> {
    let pairs = pairs(args)?;
    let alarms = (args.pairs / RATE) as usize;
    let threshold = MotionParameters::default().threshold;
    let (ours, best) = (pairs.at(0, threshold), pairs.best(0, alarms));
    let passed = ours.false_alarms <= alarms && ours.detected >= 0.99;
    let outcome = if passed { Outcome::verdict("passed") } else { Outcome::failure("wrong") };
    let value = |roc: Roc| {
        json!({
            "threshold": rounded(roc.threshold),
            "false_alarms": roc.false_alarms,
            "detected": rounded(roc.detected),
        })
    };
    Ok(Report::new(outcome)
        .field("pairs", args.pairs)
        .field("threshold", ours.threshold)
        .field("false_alarms", ours.false_alarms)
        .field("detected", rounded(ours.detected))
        .field("at_best", value(best))
        .field("book", value(pairs.at(1, BOOK)))
        .field("book_at_best", value(pairs.best(1, alarms))))
}

/// Takes the pairs, scene by scene.
pub(crate) fn pairs(args: &Args) -> Result<Pairs, Failure> {
    let wanted = args.pairs as usize;
    let mut pairs = Pairs::default();
    let mut seed = args.common.seed;
    while pairs.still.len() < wanted || pairs.moving.len() < wanted {
        for (moves, measured) in [(false, &mut pairs.still), (true, &mut pairs.moving)] {
            if measured.len() < wanted {
                let mut found = in_scene(args, seed, moves).map_err(Failure::run)?;
                found.truncate(wanted - measured.len());
                measured.append(&mut found);
            }
        }
        seed = seed.wrapping_add(1);
    }
    Ok(pairs)
}

/// The pairs of one scene in which the other robot is in view and, if required, moved.
fn in_scene(args: &Args, seed: u64, moves: bool) -> io::Result<Vec<[f64; 2]>> {
    let simulation = scene::simulated(args, seed, moves)?;
    let truth = simulation.truth();
    let mut robot = simulation.robot(0)?;
    // The motors take time to respond.
    robot.wait(1.0)?;
    let mut detector = MotionDetector::new(MotionParameters::default()).map_err(|e| wrong(&e))?;
    let mut found = Vec::new();
    for _ in 0..IN_A_SCENE {
        let (first, before) = (robot.gray_image()?, truth.pose(1)?);
        robot.wait(APART)?;
        let (second, after) = (robot.gray_image()?, truth.pose(1)?);
        let watcher = truth.pose(0)?;
        let in_view = [before, after].iter().all(|pose| {
            bearing(watcher, pose.position()).abs() < units::from_deg(24.0)
                && (0.25..1.8).contains(&watcher.distance_to(pose.position()))
        });
        if in_view && moves == (before != after) {
            found.push(measure(&mut detector, &first, &second).map_err(|e| wrong(&e))?);
        }
        robot.wait(0.2)?;
    }
    Ok(found)
}

fn measure(
    detector: &mut MotionDetector,
    first: &GrayImage,
    second: &GrayImage,
) -> Result<[f64; 2], roverlab::vision::ImageError> {
    let motion = detector.compare(first.try_into()?, second.try_into()?)?;
    Ok([motion.largest(), motion.mean_difference])
}

pub(super) fn wrong(error: &roverlab::vision::ImageError) -> io::Error {
    io::Error::new(io::ErrorKind::Other, error.to_string())
}
