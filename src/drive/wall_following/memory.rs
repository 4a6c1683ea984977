use std::collections::VecDeque;

use crate::geometry::{FittedLine, Point, Pose, Vector, direction};

/// Recent points of a sensor in the odometry frame, in order.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Memory {
    points: VecDeque<Point>,
    most: usize,
}

impl Memory {
    pub(super) fn new(most: usize) -> Self {
        Self { points: VecDeque::with_capacity(most), most }
    }

    pub(super) fn add(&mut self, point: Point) {
        if self.points.len() == self.most {
            self.points.pop_front();
        }
        self.points.push_back(point);
    }

    pub(super) fn clear(&mut self) {
        self.points.clear();
    }

    pub(super) fn len(&self) -> usize {
        self.points.len()
    }

    pub(super) fn iter(&self) -> impl Iterator<Item = Point> + Clone + '_ {
        self.points.iter().copied()
    }

    /// The mean of a few consecutive points nearest to a place. Points more than `spread` metres apart belong
    /// to different surfaces and are not averaged.
    pub(super) fn nearest(&self, to: Point, spread: f64) -> Option<Point> {
        /// Number of consecutive points whose median is taken.
        const FEW: usize = 5;
        let points: Vec<Point> = self.iter().collect();
        points
            .windows(FEW)
            .filter(|few| (few[FEW - 1] - few[0]).norm() < spread)
            .map(|few| Point::from(few.iter().map(|point| point.coords).sum::<Vector>() / FEW as f64))
            .min_by(|a, b| (a - to).norm().total_cmp(&(b - to).norm()))
    }

    /// The line through `first` and the last `count` points, in the frame of a pose.
    pub(super) fn last_line(&self, count: usize, first: &[Point], pose: &Pose) -> Option<FittedLine> {
        let skipped = self.points.len().checked_sub(count)?;
        let points = first.iter().copied().chain(self.iter().skip(skipped));
        FittedLine::through(points.map(|point| pose.to_local(point)))
    }
}

/// The point hit by a sensor, in the odometry frame; `None` without a return.
pub(super) fn hit(pose: &Pose, mount: &Pose, range: f64) -> Option<Point> {
    range.is_finite().then(|| pose.to_world(mount.position() + direction(mount.heading) * range))
}

/// Median of a sensor's last readings, which suppresses single outliers.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Median {
    last: [f64; Self::WIDTH],
    next: usize,
}

impl Median {
    /// Number of readings whose median is taken.
    const WIDTH: usize = 5;

    pub(super) fn new() -> Self {
        Self { last: [f64::INFINITY; Self::WIDTH], next: 0 }
    }

    pub(super) fn add(&mut self, reading: f64) -> f64 {
        self.last[self.next] = reading;
        self.next = (self.next + 1) % Self::WIDTH;
        self.value()
    }

    pub(super) fn value(&self) -> f64 {
        let mut sorted = self.last;
        sorted.sort_by(f64::total_cmp);
        sorted[Self::WIDTH / 2]
    }
}
