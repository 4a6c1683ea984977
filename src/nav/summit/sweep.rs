use crate::geometry::{Point3, Pose3, Vector3, direction, math, units};
use crate::io::{Attitude, LidarScan};
use crate::nav::elevation::Climber;

/// The tilts of the scans of a look around, in degrees: the nearer to level, the closer together, as ground
/// far away shows little of itself.
const TILTS: [f64; 24] = [
    -60.0, -48.0, -39.0, -32.0, -26.0, -21.5, -18.0, -15.0, -12.5, -10.5, -9.0, -7.5, -6.3, -5.2, -4.2, -3.2,
    -2.2, -1.2, 0.0, 2.0, 5.0, 9.0, 14.0, 20.0,
];

/// The same for levels nearby: a ramp behind a crest shows only to beams steeper than itself.
const NEARBY: [f64; 40] = [
    -60.0, -54.0, -48.0, -44.0, -40.0, -37.0, -34.0, -32.0, -30.0, -28.5, -27.0, -25.5, -24.0, -23.0, -22.0,
    -21.0, -20.0, -19.0, -18.0, -17.0, -16.0, -15.0, -14.0, -13.0, -12.0, -11.0, -10.0, -9.0, -8.0, -7.0,
    -6.0, -5.0, -4.0, -3.0, -2.0, -1.0, 0.0, 3.0, 8.0, 15.0,
];

/// Depth below what a slope could lead to from which ground is a drop (m).
pub(super) const DROP: f64 = 0.04;

/// Scans at many tilts from one place, with the attitude in the meantime.
#[derive(Debug, Clone)]
pub(super) struct Sweep {
    tilts: &'static [f64],
    /// By tilt and then by beam: unit directions in the robot's frame, and metres.
    rings: Vec<Vec<(Vector3, f64)>>,
    attitudes: Vec<Attitude>,
}

/// A beam in the map's frame.
#[derive(Debug, Clone, Copy)]
pub(super) struct Beam {
    pub(super) origin: Point3,
    pub(super) direction: Vector3,
    /// Infinite without a return.
    pub(super) range: f64,
    /// Whether it ends on a face that is steeper than what the robot drives on, and higher than what it
    /// climbs.
    pub(super) is_on_face: bool,
    /// Whether there is a drop between the end of the beam below it and its own.
    pub(super) is_past_drop: bool,
}

impl Beam {
    pub(super) fn end(&self) -> Option<Point3> {
        self.range.is_finite().then(|| self.origin + self.direction * self.range)
    }
}

impl Sweep {
    /// A sweep that shows ground far away.
    pub(super) fn wide() -> Self {
        Self { tilts: &TILTS, rings: Vec::new(), attitudes: Vec::new() }
    }

    /// A sweep that shows ground nearby.
    pub(super) fn nearby() -> Self {
        Self { tilts: &NEARBY, ..Self::wide() }
    }

    /// The tilt of the next scan, in radians; `None` once it is complete.
    pub(super) fn next_tilt(&self) -> Option<f64> {
        self.tilts.get(self.rings.len()).map(|&degrees| units::from_deg(degrees))
    }

    /// Adds the scan of the tilt that is next.
    pub(super) fn add(&mut self, lidar: &Pose3, scan: &LidarScan, attitude: Attitude) {
        let Some(tilt) = self.next_tilt() else { return };
        let (rise, run) = math::sin_cos(tilt);
        let beam = |(index, &range): (usize, &f64)| {
            let flat = direction(scan.angle(index));
            (lidar.rotate(Vector3::new(flat.x * run, flat.y * run, rise)), range)
        };
        self.rings.push(scan.ranges.iter().enumerate().map(beam).collect());
        self.attitudes.push(attitude);
    }

    /// The mean attitude.
    pub(super) fn attitude(&self) -> Attitude {
        let count = self.attitudes.len().max(1) as f64;
        let mean = |of: fn(&Attitude) -> f64| self.attitudes.iter().map(of).sum::<f64>() / count;
        Attitude { roll: mean(|a| a.roll), pitch: mean(|a| a.pitch), yaw: 0.0 }
    }

    /// The beams of each azimuth, from the lowest tilt up, as seen from a robot in the map's frame.
    pub(super) fn fans(
        &self,
        robot: &Pose3,
        lidar: &Pose3,
        climber: &Climber,
    ) -> impl Iterator<Item = Vec<Beam>> {
        let origin = robot.to_world(lidar.position);
        let beams = self.rings.iter().map(Vec::len).min().unwrap_or(0);
        (0..beams).map(move |index| {
            let beam = |ring: &Vec<(Vector3, f64)>| {
                let (own, range) = ring[index];
                Beam { origin, direction: robot.rotate(own), range, is_on_face: false, is_past_drop: false }
            };
            let mut fan: Vec<Beam> = self.rings.iter().map(beam).collect();
            mark_faces(&mut fan, climber);
            mark_drops(&mut fan, climber);
            fan
        })
    }
}

/// Finds the beams of a fan that end on faces: above each other, they rise by more than a slope and a step
/// together that the robot drives over.
fn mark_faces(fan: &mut [Beam], climber: &Climber) {
    // What they rise beyond a slope, from the last one before the face.
    let (mut excess, mut before) = (0.0, 0);
    for index in 1..fan.len() {
        let ends = [fan[index - 1].end(), fan[index].end()];
        let rise = match ends {
            [Some(below), Some(end)] => {
                let way = end - below;
                way.z - math::tan(climber.slope) * way.xy().norm()
            }
            _ => f64::NEG_INFINITY,
        };
        excess += rise;
        if excess <= 0.0 {
            (excess, before) = (0.0, index);
        } else if excess > climber.step {
            for beam in &mut fan[before + 1..=index] {
                beam.is_on_face = true;
            }
        }
    }
}

/// Finds the beams of a fan that end beyond a drop: lower than if the ground fell all the way there as it
/// does before the drop, or as it does behind it.
fn mark_drops(fan: &mut [Beam], climber: &Climber) {
    let steepest = math::tan(climber.slope);
    for index in 2..fan.len().saturating_sub(1) {
        let ends = [index - 2, index - 1, index, index + 1].map(|beam| fan[beam].end());
        let [Some(first), Some(above), Some(below), Some(last)] = ends else { continue };
        let falls = |from: Point3, to: Point3| {
            let way = to - from;
            (-way.z / way.xy().norm().max(f64::MIN_POSITIVE)).clamp(0.0, steepest)
        };
        let leads = falls(first, above).max(falls(below, last)) * (below - above).xy().norm();
        fan[index].is_past_drop = above.z - below.z > leads + DROP;
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::Point3;
    use crate::nav::SummitParameters;
    use crate::world::RobotSpec;

    /// What a fan from 0.15 m above the ground meets, by how high the ground is so far ahead.
    fn fan(ground: impl Fn(f64) -> f64) -> Vec<Beam> {
        let origin = Point3::new(0.0, 0.0, 0.15);
        let beam = |&degrees: &f64| {
            let (rise, run) = math::sin_cos(units::from_deg(degrees));
            let meets = (0..5000).map(|step| 0.001 * f64::from(step));
            let mut meets = meets.filter(|range| origin.z + range * rise <= ground(range * run));
            let range = meets.next().unwrap_or(f64::INFINITY);
            Beam {
                origin,
                direction: Vector3::new(run, 0.0, rise),
                range,
                is_on_face: false,
                is_past_drop: false,
            }
        };
        TILTS.iter().map(beam).collect()
    }

    /// How far ahead the beams on faces end.
    fn faces(ground: impl Fn(f64) -> f64) -> Vec<f64> {
        let mut fan = fan(ground);
        mark_faces(&mut fan, &SummitParameters::of(&RobotSpec::blizzard()).unwrap().climber);
        fan.iter().filter(|beam| beam.is_on_face).filter_map(|beam| Some(beam.end()?.x)).collect()
    }

    #[test]
    fn sides_that_are_too_high_are_faces() {
        for height in [0.05, 0.065, 0.3] {
            let found = faces(|ahead| if ahead < 1.0 { 0.0 } else { height });
            assert!(!found.is_empty(), "{height}: {found:?}");
            assert!(found.iter().all(|ahead| (0.99..1.01).contains(ahead)), "{height}: {found:?}");
        }
    }

    /// Where beams of a fan end beyond drops.
    fn drops(ground: impl Fn(f64) -> f64) -> Vec<f64> {
        let mut fan = fan(ground);
        mark_drops(&mut fan, &SummitParameters::of(&RobotSpec::blizzard()).unwrap().climber);
        let past = fan.iter().filter(|beam| beam.is_past_drop);
        past.filter_map(|beam| Some(beam.end()?.x)).collect()
    }

    #[test]
    fn what_no_slope_leads_to_is_a_drop() {
        for height in [0.06, 0.09, 0.2] {
            let found = drops(|ahead| if ahead < 0.4 { 0.0 } else { -height });
            assert!(found.len() == 1 && (0.4..1.2).contains(&found[0]), "{height}: {found:?}");
        }
    }

    #[test]
    fn ground_to_drive_down_has_no_drops() {
        assert!(drops(|ahead| if ahead < 0.4 { 0.0 } else { -0.03 }).is_empty());
        for degrees in [5.0, 10.0, 20.0] {
            let rise = math::tan(units::from_deg(degrees));
            assert!(drops(|ahead| -rise * (ahead - 0.4).max(0.0)).is_empty(), "{degrees}");
            assert!(drops(|ahead| -rise * ahead).is_empty(), "{degrees}");
            assert!(drops(|ahead| rise * ahead).is_empty(), "{degrees}");
        }
    }

    #[test]
    fn ground_to_drive_on_has_no_faces() {
        assert!(faces(|_| 0.0).is_empty());
        assert!(faces(|ahead| if ahead < 1.0 { 0.0 } else { 0.015 }).is_empty());
        for degrees in [10.0, 20.0] {
            let rise = math::tan(units::from_deg(degrees));
            assert!(faces(|ahead| (rise * (ahead - 0.5)).clamp(0.0, 0.4)).is_empty(), "{degrees}");
        }
    }
}
