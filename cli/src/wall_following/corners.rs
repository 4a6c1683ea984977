use std::f64::consts::{FRAC_PI_3, PI};

use roverlab::geometry::{Point, Vector, math};
use roverlab::world::World;

/// A corner between walls, or the end of one.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Corner {
    pub(crate) place: Point,
    /// Distance from it that counts as near (m).
    pub(crate) reach: f64,
}

/// Distance below which ends of walls are joined (m).
const JOINED: f64 = 0.02;
/// Angle below which joined walls make no corner (rad).
const STRAIGHT: f64 = 0.25;
/// Distance behind a corner in which the robot returns to its distance (m).
const MARGIN: f64 = 0.15;

/// Corners of a world for a robot that keeps a distance (m).
pub(crate) fn corners(world: &World, distance: f64) -> Vec<Corner> {
    let ends: Vec<(Point, Vector)> = world
        .walls
        .iter()
        .flat_map(|wall| {
            let along = wall.line.b - wall.line.a;
            [(wall.line.a, along), (wall.line.b, -along)]
        })
        .collect();
    (0..ends.len()).filter_map(|i| corner(&ends, i, distance)).collect()
}

fn corner(ends: &[(Point, Vector)], index: usize, distance: f64) -> Option<Corner> {
    let (place, along) = ends[index];
    let joined = ends.iter().enumerate().filter(|&(i, (end, _))| i != index && (end - place).norm() < JOINED);
    let between = |other: &Vector| {
        let cosine = along.dot(other) / (along.norm() * other.norm()).max(1e-12);
        math::acos(cosine.clamp(-1.0, 1.0))
    };
    let angles: Vec<f64> = joined.map(|(_, (_, other))| between(other)).collect();
    if angles.len() == 1 && angles[0] > PI - STRAIGHT {
        return None;
    }
    let sharpest = angles.into_iter().fold(PI, f64::min).max(FRAC_PI_3);
    // A free end counts as a sharp corner.
    let sharpest = if sharpest > PI - 1e-9 { FRAC_PI_3 } else { sharpest };
    Some(Corner { place, reach: distance / math::sin(0.5 * sharpest) + MARGIN })
}
