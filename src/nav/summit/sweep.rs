use crate::geometry::{Point3, Pose3, Vector3, direction, math, units};
use crate::io::{Attitude, LidarScan};

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
    pub(super) fn fans<'s>(
        &'s self,
        robot: &'s Pose3,
        lidar: &Pose3,
    ) -> impl Iterator<Item = impl Iterator<Item = Beam> + 's> + 's {
        let origin = robot.to_world(lidar.position);
        let beams = self.rings.iter().map(Vec::len).min().unwrap_or(0);
        (0..beams).map(move |index| {
            self.rings.iter().map(move |ring| {
                let (own, range) = ring[index];
                Beam { origin, direction: robot.rotate(own), range }
            })
        })
    }
}
