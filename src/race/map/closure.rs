//! Closing the first lap of a cone map.

use super::super::registration::{Expected, GATE, register, spread};
use super::{ATHWART, BEHIND, ConeMap, FRESH, Landmark, SHORTEST_LAP, STRIDE, WRONG, wrong_after};
use crate::geometry::{Point, Pose};

/// Distance from an earlier position at which a lap has returned to it (m).
const AROUND: f64 = 2.5;

impl ConeMap {
    /// Closes the first lap if the first cones are among those seen now: the accumulated error is distributed
    /// over the lap, and duplicate cones are merged. Returns whether the map is closed.
    pub fn close(&mut self) -> bool {
        if self.closed {
            return true;
        }
        if self.confirmed().all(|landmark| self.is_fresh(landmark)) {
            // A short lap has led back to recently passed cones: pose and map are consistent already.
            (self.closed, self.known) = (true, self.way);
            self.drop_earlier_laps();
            return true;
        }
        let beginning = self.beginning();
        let first = |l: &&Landmark| l.first < beginning && !self.is_fresh(l);
        let last = |l: &&Landmark| self.way - l.last < BEHIND && l.first > beginning;
        let at = |landmark: &Landmark| landmark.position;
        let onto: Vec<Point> = self.confirmed().filter(first).map(at).collect();
        let points: Vec<Point> = self.confirmed().filter(last).map(at).collect();
        let expected =
            Expected { place: self.pose.position(), wrong: (wrong_after(self.way - self.begun), WRONG.2) };
        let Some(motion) = register(&points, &onto, expected) else { return false };
        self.bend(motion);
        self.merge();
        (self.closed, self.known) = (true, self.way);
        true
    }

    /// Takes only the last `metres` as the first lap, if it could not be closed: rows of cones on a straight
    /// may look alike in many places, and be distinctive farther on. Does nothing below twice the distance
    /// within which cones are fresh.
    pub(in crate::race) fn begin_later(&mut self, metres: f64) {
        let begun = self.way - metres;
        if self.closed || begun <= self.begun || metres < 2.0 * FRESH {
            return;
        }
        self.begun = begun;
        self.landmarks.retain(|landmark| landmark.last >= begun);
        self.trail.retain(|(_, way)| *way >= begun);
    }

    /// Moves the end of the lap by a motion, its start not at all, and the rest in proportion to the
    /// distance.
    fn bend(&mut self, motion: Pose) {
        self.trail.push((self.pose, self.way));
        let beginning = self.beginning();
        let until = (self.way - BEHIND - (beginning - self.begun)).max(beginning + STRIDE);
        let share = |way: f64| ((way - beginning) / (until - beginning)).clamp(0.0, 1.0);
        let (before, shares): (Vec<Pose>, Vec<f64>) =
            self.trail.iter().map(|(pose, way)| (*pose, share(*way))).unzip();
        let after = spread(&before, &shares, motion);
        for landmark in &mut self.landmarks {
            let node = self.trail.partition_point(|(_, way)| *way < landmark.mean).min(before.len() - 1);
            landmark.position = after[node].to_world(before[node].to_local(landmark.position));
        }
        for ((pose, _), new) in self.trail.iter_mut().zip(&after) {
            *pose = *new;
        }
        self.pose = after[after.len() - 1];
        // The lap ends where it began, not where the closure was noticed.
        let (begin, _) = self.trail[0];
        let is_beyond = |(pose, _): &(Pose, f64)| begin.to_local(pose.position()).x > -STRIDE;
        while self.trail.len() > 2 && self.trail.last().is_some_and(is_beyond) {
            self.trail.pop();
        }
    }

    /// Keeps only the last lap of the trail: a short lap may be driven more than once before the line is
    /// crossed again.
    fn drop_earlier_laps(&mut self) {
        let (pose, way) = (self.pose, self.way);
        let away = |at: &Pose| (at.position() - pose.position()).norm();
        let around = self.trail.iter().enumerate().filter(|(_, (at, then))| {
            way - then > SHORTEST_LAP && away(at) < AROUND && at.forward().dot(&pose.forward()) > ATHWART
        });
        // Of all passes, take the last one, and there the nearest pose.
        let Some((last, _)) = around.clone().next_back() else { return };
        let once = around.filter(|(_, (_, then))| self.trail[last].1 - then < 2.0 * AROUND);
        let nearest = once.min_by(|(_, (a, _)), (_, (b, _))| away(a).total_cmp(&away(b)));
        self.trail.drain(..=nearest.map_or(last, |(at, _)| at));
        if self.trail.last().is_some_and(|(_, then)| way - then > 0.5 * STRIDE) {
            self.trail.push((pose, way));
        }
    }

    /// Distance driven up to which cones count as the first ones (m).
    fn beginning(&self) -> f64 {
        self.begun + FRESH.min(0.5 * (self.way - self.begun))
    }

    /// Merges cones that are too close together to be two.
    fn merge(&mut self) {
        let mut kept: Vec<Landmark> = Vec::with_capacity(self.landmarks.len());
        for landmark in &self.landmarks {
            let near = |other: &&mut Landmark| (other.position - landmark.position).norm() < GATE;
            match kept.iter_mut().find(near) {
                Some(other) => other.join(landmark),
                None => kept.push(*landmark),
            }
        }
        self.landmarks = kept;
    }
}
